#pragma once
// The scene's triangles as rays meet them, in the pinhole camera's space: x right, y up,
// the camera at the origin looking along -z.

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "raster/numbers/profile.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/draw/frame_matrices.h"
#include "scenes/scene.h"

namespace softfocus {

/// One object.
struct RayMesh {
  SurfaceDraw draw;
  std::vector<glm::vec3> positions;  ///< in camera space
  std::vector<glm::vec3> world;
  std::vector<glm::vec3> normals;  ///< in the world, unit length
  /// Light that does not depend on where it is seen from, front and back.
  std::vector<glm::vec3> base[2];
};

/// `materials`, if any, stand for the scene's, and must outlive the result.
std::vector<RayMesh> ray_meshes(const Scene& scene, const CameraMatrices& camera, double frame,
                                std::span<const Material> materials = {});

/// From a point of the lens through one of the plane in focus; z of the direction is -1, so
/// that the distance along the ray is the depth in metres.
struct LensRay {
  glm::dvec3 origin;
  glm::dvec3 direction;
};

/// Where a ray looks: a pixel's place is (x + 0.5, y + 0.5) and an offset.
struct RayCamera {
  double pixel_x, pixel_y;    ///< tangents per pixel
  double centre_x, centre_y;  ///< the pixel coordinate of the axis
  double focus_m;
};
RayCamera ray_camera(const CameraMatrices& camera, double focus_m, int width_px, int height_px);
LensRay lens_ray(const RayCamera& camera, glm::dvec2 lens_point_m, double x_px, double y_px);

/// Whether the ray meets the front of a triangle, as the rasterizer has it.
bool meets_front(const RayMesh& mesh, std::uint32_t triangle, const LensRay& ray);

/// A place on a triangle: weights of its second and third vertex.
struct RayHit {
  std::uint32_t triangle;
  float weight_1, weight_2;
};

/// Linear colour, as SurfaceVertexStage and SurfaceFragmentStage have it: light at the
/// vertices, interpolated. `eye` is the lens point in the world; `corner` is the ray
/// through the upper left of the 2x2 block of pixels, `right` and `below` through its
/// neighbours: textures are sampled at the level of detail that the rasterizer would
/// choose for this view, from differences over the block.
struct BlockRays {
  LensRay corner, right, below;
};
glm::vec3 shade_hit(const RayMesh& mesh, const RayHit& hit, glm::vec3 eye, const LensRay& ray,
                    const BlockRays& block, const Profile& profile);

/// The vertices' highlights as one eye sees them, front and back, for surfaces that have some.
struct SpecularLight {
  std::vector<glm::vec3> side[2];
};
SpecularLight highlights_from(const RayMesh& mesh, glm::vec3 eye);

/// shade_hit() with the highlights known, of the front or the back.
glm::vec3 shade_hit(const RayMesh& mesh, const RayHit& hit, bool back,
                    const SpecularLight& highlights, const BlockRays& block,
                    const Profile& profile);

/// A place's opacity, 0 in holes. It is sampled as textures are.
float opacity_at(const RayMesh& mesh, const RayHit& hit, const BlockRays& block,
                 const Profile& profile);

/// Where a ray meets the triangle's plane, moved into the triangle if it lies outside.
RayHit hit_in_triangle(const RayMesh& mesh, std::uint32_t triangle, const LensRay& ray);

/// The triangle's corners in camera space.
std::array<glm::dvec3, 3> corner_positions(const RayMesh& mesh, std::uint32_t triangle);

}  // namespace softfocus

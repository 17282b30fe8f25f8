#pragma once
// The shapes of geometry books as meshes: closed (but for the plane), with unit normals
// and uvs, counter-clockwise from outside. Sizes are metres and above 0. Points that
// two grids share have the same bits, so that welding by position closes each shape.

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "scenes/scene.h"

namespace softfocus {

/// About the origin. `segments` >= 3 around the y axis, `rings` >= 2 from pole to pole:
/// 2 segments (rings - 1) triangles. u runs around eastwards from +z, v from the
/// north pole down.
Mesh make_sphere(double radius, int segments, int rings);

/// About the origin, the hole along y. `ring_radius` goes from the centre to the
/// middle of the tube, `tube_radius` < ring_radius. 2 segments sides triangles, both
/// counts >= 3. u runs around the ring, v around the tube from the top outwards.
Mesh make_torus(double ring_radius, double tube_radius, int segments, int sides);

/// Stands on y = 0 with the tip at y = height and a base cap; the side is cut into
/// `rings` >= 1 bands, `segments` >= 3: 2 segments rings triangles with the cap.
Mesh make_cone(double radius, double height, int segments, int rings);

/// About the origin, `size` along each edge, six faces of cells x cells, each with
/// the whole texture: 12 cells^2 triangles. Lighting is by vertex, so a face near a
/// lamp needs cells.
Mesh make_cube(double size, int cells);

/// About the origin in y = 0, facing up: `width` along x, `depth` along z,
/// 2 cells_x cells_z triangles. u along x, v along z.
Mesh make_plane(double width, double depth, int cells_x, int cells_z);

/// The shape as a room: winding and normals flipped, u mirrored, so that a picture on
/// a wall still reads the right way round.
Mesh inside_out(Mesh mesh);

/// Lets the texture repeat: multiplies every uv.
void repeat_uvs(Mesh& mesh, glm::dvec2 times);

// Balls at random places, none touching another: the same ones on every machine.

struct Ball {
  glm::dvec3 centre{0.0};
  double radius = 1.0;
};

struct BallRule {
  int count = 1;
  std::uint64_t seed = 1;
  glm::dvec3 region_min{-1.0};  ///< of the centres
  glm::dvec3 region_max{1.0};
  double radius_min = 0.1;
  double radius_max = 0.1;
  double gap = 0.0;        ///< least distance between two surfaces
  bool on_ground = false;  ///< the balls lie on y = region_min.y
};

/// Draws radius, x, y and z of each ball, in this order. Draws x, y and z again while the ball
/// is nearer than `gap` to an obstacle or an earlier ball. Empty if a ball finds no place in
/// kBallAttempts.
std::optional<std::vector<Ball>> place_balls(const BallRule& rule,
                                             const std::vector<Ball>& obstacles);

inline constexpr int kBallAttempts = 1000;
/// Each place is compared with every ball, so time grows with the square.
inline constexpr int kMostBalls = 4096;

// A scene of as many triangles as one asks for: 250 equal spheres in front of the camera,
// from half the focus distance to far beyond it, that cover most of the picture.

inline constexpr int kFieldSpheres = 250;
inline constexpr int kLeastFieldTriangles = 1500;  ///< 6 a sphere, the coarsest there is
inline constexpr int kMostFieldTriangles = 8'000'000;

/// How a sphere is cut (make_sphere()).
struct SphereCut {
  int segments;
  int rings;
};

/// The cut whose 250 spheres have the number of triangles nearest to `triangles`, with cells
/// between square and four times as high as wide at the equator.
/// Needs kLeastFieldTriangles <= triangles <= kMostFieldTriangles.
SphereCut sphere_cut(int triangles);

/// The field for a picture `aspect` times as wide as high. 64000, 256000 and 1024000
/// triangles are met exactly.
Scene sphere_field(int triangles, double aspect);

}  // namespace softfocus

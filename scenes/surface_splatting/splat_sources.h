#pragma once
// The scene's triangles on the pinhole's screen, where surface_splats.h takes its points.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "dof/dof.h"
#include "raster/images/image.h"
#include "scenes/lens_views/lens_view_method.h"
#include "scenes/lens_views/ray_geometry.h"

namespace softfocus {

/// A level's cells have 2^level pixels a side, 1 to 64.
inline constexpr int kSplatLevels = 7;
/// Of the cell for a circle.
inline int splat_level(float radius_px) {
  int level = 0;
  while (level + 1 < kSplatLevels && static_cast<float>(3 << (level + 1)) <= radius_px) ++level;
  return level;
}

/// One object, and its highlights as the pinhole sees them.
struct SeenMesh {
  RayMesh mesh;
  SpecularLight highlights;
};

/// A triangle's convex polygon on the screen, after the near plane has cut it.
struct SeenTriangle {
  std::uint32_t surface, triangle;
  bool back;
  int corners;
  std::array<std::int64_t, 4> x, y;  // in subpixels, in the order that makes the area positive
  glm::dvec3 inverse_depth;          // at a place on the screen: x * .x + y * .y + .z
  double least_inverse, most_inverse;
  int top_px, bottom_px;  // of what can reach the picture
  int left_px, right_px;
  int least_level, most_level;
};

struct SplatCamera {
  int width, height;
  RayCamera rays;
  double near_m, far_m;
  double radius_per_inverse;  // r = this * (1/focus - 1/depth), in pixels
  double inverse_focus;

  float radius_px(double inverse_depth) const {
    const double radius = std::fabs(radius_per_inverse * (inverse_focus - inverse_depth));
    return static_cast<float>(std::min(radius, static_cast<double>(kLargestMaxCoc)));
  }
};

SplatCamera splat_camera(const LensViewInput& input);

std::vector<SeenMesh> seen_meshes(const LensViewInput& input);

/// Those that the pinhole, or what a splat of theirs reaches, can show, mesh by mesh.
std::vector<SeenTriangle> seen_triangles(const SplatCamera& camera,
                                         const std::vector<SeenMesh>& meshes);

// Points of the scene that no point of the lens sees.

/// The farthest depth that the pinhole sees in squares of 2^k pixels, k = 0, 1, ...
struct Farthest {
  struct Level {
    int width, height;
    std::vector<float> depth_m;
  };
  std::vector<Level> levels;

  float at(std::size_t level, int x, int y) const {
    const Level& of = levels[level];
    return of.depth_m[static_cast<std::size_t>(y * of.width + x)];
  }
};

/// Of a drawn picture, depth in alpha.
Farthest farthest_of(const Image& pinhole);

/// Whether no point of the lens sees a point of a surface, at (x, y) pixels: from anywhere on the
/// lens, what the pinhole sees before it moves by up to the difference of their circles, and all
/// around is nearer than the point. A circle's radius changes by `radius_per_inverse` pixels with
/// 1/depth. `step` is the distance of the points in pixels. Outside the picture nothing is
/// hidden.
bool is_hidden(const Farthest& farthest, double radius_per_inverse, double x, double y,
               double inverse_depth, int step);

}  // namespace softfocus

#pragma once
// Points of the scene that no point of the lens sees.

#include <cstddef>
#include <vector>

#include "raster/images/image.h"

namespace softfocus {

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

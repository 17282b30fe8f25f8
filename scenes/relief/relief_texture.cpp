#include "scenes/relief/relief_texture.h"

#include <algorithm>
#include <limits>

#include "raster/numbers/vector_math.h"

namespace softfocus {

double source_distance(const ReliefCamera& camera) {
  if (!camera.eye) return std::numeric_limits<double>::infinity();
  return dot(camera.origin - *camera.eye, camera.f);
}

glm::dvec3 point_at_depth(const ReliefCamera& camera, double u, double v, double depth_m) {
  const glm::dvec3 in_plane = (camera.origin + camera.a * u) + camera.b * v;
  if (!camera.eye) return in_plane + camera.f * depth_m;
  return *camera.eye + (in_plane - *camera.eye) * (1.0 / (1.0 - depth_m / source_distance(camera)));
}

glm::dvec3 relief_point(const ReliefTexture& relief, double u, double v, double code) {
  return point_at_depth(relief.camera, u, v, code * depth_step(relief));
}

std::optional<ReliefExtent> relief_extent(const ReliefTexture& relief) {
  const std::uint16_t empty = empty_depth(relief.depth_bits);
  ReliefExtent extent{relief.width, 0, relief.height, 0, empty, 0, 0};
  for (int y = 0; y < relief.height; ++y) {
    const std::uint16_t* codes =
        relief.depths.data() + static_cast<std::ptrdiff_t>(y) * relief.width;
    for (int x = 0; x < relief.width; ++x) {
      if (codes[x] == empty) continue;
      extent.x_begin = std::min(extent.x_begin, x);
      extent.x_end = std::max(extent.x_end, x + 1);
      extent.y_begin = std::min(extent.y_begin, y);
      extent.y_end = y + 1;
      extent.least_code = std::min<int>(extent.least_code, codes[x]);
      extent.most_code = std::max<int>(extent.most_code, codes[x]);
      ++extent.filled;
    }
  }
  if (extent.filled == 0) return std::nullopt;
  return extent;
}

}  // namespace softfocus

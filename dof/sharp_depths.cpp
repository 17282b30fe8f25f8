#include "dof/sharp_depths.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "dof/dof.h"
#include "raster/numbers/half.h"

namespace softfocus {

float sharp_depths_radius_px(std::span<const SharpDepths> ranges, float depth_m) {
  float least_px = kLargestMaxCoc;
  for (const SharpDepths& range : ranges) {
    if (depth_m >= range.at_near.focus_m && depth_m <= range.at_far.focus_m) return 0.0f;
    for (const PixelCoc& coc : {range.at_near, range.at_far}) {
      const float radius_px =
          std::isfinite(depth_m) ? coc_radius_px(coc, depth_m) : coc.radius_at_infinity_px;
      least_px = std::min(least_px, std::fabs(radius_px));
    }
  }
  return least_px;
}

std::vector<float> sharp_depths_radii(const ConstImageView& scene,
                                      std::span<const SharpDepths> ranges, ThreadPool& pool) {
  const auto width = static_cast<std::size_t>(scene.width);
  std::vector<float> radii(width * static_cast<std::size_t>(scene.height));
  pool.for_each(scene.height, [&](int y) {
    const auto texels = row<std::uint16_t>(scene, y);
    float* to = radii.data() + static_cast<std::size_t>(y) * width;
    for (std::size_t x = 0; x < width; ++x) {
      to[x] = sharp_depths_radius_px(ranges, half_to_float(texels[4 * x + 3]));
    }
  });
  return radii;
}

}  // namespace softfocus

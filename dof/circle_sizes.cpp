#include "dof/circle_sizes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "dof/dof.h"
#include "raster/numbers/half.h"

namespace softfocus {
namespace {

struct RowSizes {
  float largest_px = 0.0f;
  int beyond_limit = 0;
};

}  // namespace

CircleSizes circle_sizes(const ConstImageView& scene, const PixelCoc& coc, float limit_px,
                         ThreadPool& pool) {
  std::vector<RowSizes> rows(static_cast<std::size_t>(scene.height));
  pool.for_each(scene.height, [&](int y) {
    RowSizes& sizes = rows[static_cast<std::size_t>(y)];
    const auto values = row<std::uint16_t>(scene, y);
    for (std::size_t i = 3; i < values.size(); i += 4) {
      const float depth_m = half_to_float(values[i]);
      const float radius =
          std::isinf(depth_m) ? coc.radius_at_infinity_px : std::fabs(coc_radius_px(coc, depth_m));
      if (radius > sizes.largest_px) sizes.largest_px = radius;
      if (radius > limit_px) ++sizes.beyond_limit;
    }
  });
  CircleSizes all;
  double beyond = 0.0;
  for (const RowSizes& sizes : rows) {
    all.largest_px = std::max(all.largest_px, std::min(sizes.largest_px, kLargestMaxCoc));
    beyond += sizes.beyond_limit;
  }
  all.beyond_limit = beyond / (static_cast<double>(scene.width) * scene.height);
  return all;
}

}  // namespace softfocus

#include "tools/refocus/finer_depths.h"

#include <algorithm>

namespace softfocus {

std::optional<PixelCoc> with_finer_depths(DepthMap& map, const PixelCoc& coc) {
  constexpr double kEnough = 64.0;  // pixels: a 32nd is known of these
  const auto far_px = static_cast<double>(coc.radius_at_infinity_px);
  if (far_px <= kEnough || map.metres.empty()) return std::nullopt;
  const double focus_m = static_cast<double>(coc.focus_m);
  const auto radius_of = [&](float metres) {
    const auto z = static_cast<double>(metres);
    return far_px * (z - focus_m) / z;
  };
  const auto ends = std::minmax_element(map.metres.begin(), map.metres.end());
  const double nearest = radius_of(*ends.first), farthest = radius_of(*ends.second);
  // Not so near the farthest that depths there become many, nor so small that the nearest leave
  // what halves can hold.
  const double other_px = std::max(1.125 * farthest, 4.0);
  if (other_px - nearest > 0.5 * (far_px - nearest)) return std::nullopt;
  constexpr double kOtherFocus = 16.0;
  for (float& metres : map.metres) {
    metres = static_cast<float>(kOtherFocus * other_px / (other_px - radius_of(metres)));
  }
  return PixelCoc{static_cast<float>(other_px), static_cast<float>(kOtherFocus)};
}

}  // namespace softfocus

#include "tools/refocus/depth/finer_depths.h"

#include <algorithm>

namespace softfocus {
namespace {

double radius_px(double far_px, double focus_m, float metres) {
  const auto z = static_cast<double>(metres);
  return far_px * (z - focus_m) / z;
}

constexpr double kOtherFocus = 16.0;

}  // namespace

std::optional<FinerLens> finer_lens(float nearest_m, float farthest_m, const PixelCoc& coc) {
  constexpr double kEnough = 64.0;  // pixels: a 32nd is known of these
  const auto far_px = static_cast<double>(coc.radius_at_infinity_px);
  if (far_px <= kEnough) return std::nullopt;
  const double focus_m = static_cast<double>(coc.focus_m);
  const double nearest = radius_px(far_px, focus_m, nearest_m);
  const double farthest = radius_px(far_px, focus_m, farthest_m);
  // Not so near the farthest that depths there become many, nor so small that the nearest leave
  // what halves can hold.
  const double other_px = std::max(1.125 * farthest, 4.0);
  if (other_px - nearest > 0.5 * (far_px - nearest)) return std::nullopt;
  return FinerLens{
      far_px, focus_m, other_px, {static_cast<float>(other_px), static_cast<float>(kOtherFocus)}};
}

void to_finer_depths(std::span<float> metres, const FinerLens& lens) {
  for (float& depth_m : metres) {
    const double radius = radius_px(lens.far_px, lens.focus_m, depth_m);
    depth_m = static_cast<float>(kOtherFocus * lens.other_px / (lens.other_px - radius));
  }
}

std::optional<PixelCoc> with_finer_depths(DepthMap& map, const PixelCoc& coc) {
  if (map.metres.empty()) return std::nullopt;
  const auto ends = std::minmax_element(map.metres.begin(), map.metres.end());
  const std::optional<FinerLens> lens = finer_lens(*ends.first, *ends.second, coc);
  if (!lens) return std::nullopt;
  to_finer_depths(map.metres, *lens);
  return lens->coc;
}

}  // namespace softfocus

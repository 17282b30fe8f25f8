// Depths of another lens with the same circles, known better.

#include "tools/refocus/depth/mend_depth.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "raster/numbers/half.h"

using namespace softfocus;

namespace {

float as_half(float value) {
  return half_to_float(float_to_half(value, HalfRounding::nearest_even));
}

/// Depths from `near_m` to `far_m`.
DepthMap ramp(float near_m, float far_m) {
  DepthMap map{100, 1, {}};
  for (int i = 0; i < 100; ++i) {
    map.metres.push_back(near_m + (far_m - near_m) * static_cast<float>(i) / 99.0f);
  }
  return map;
}

/// The largest error of a circle whose depth passes through a half.
double largest_error(const PixelCoc& lens, const DepthMap& true_depths, const PixelCoc& used,
                     const DepthMap& depths) {
  double largest = 0.0;
  for (std::size_t i = 0; i < depths.metres.size(); ++i) {
    const auto z = static_cast<double>(true_depths.metres[i]);
    const auto focus_m = static_cast<double>(lens.focus_m);
    const double expected = static_cast<double>(lens.radius_at_infinity_px) * (z - focus_m) / z;
    const auto got = static_cast<double>(coc_radius_px(used, as_half(depths.metres[i])));
    largest = std::max(largest, std::fabs(got - expected));
  }
  return largest;
}

}  // namespace

TEST_CASE("a close-up's circles are known to a hundredth of a pixel, not to a quarter") {
  const PixelCoc lens{500.0f, 0.3f};
  const DepthMap depths = ramp(0.294f, 0.306f);
  DepthMap finer = depths;
  const std::optional<PixelCoc> other = with_finer_depths(finer, lens);
  REQUIRE(other);
  CHECK(largest_error(lens, depths, lens, depths) > 0.1);
  CHECK(largest_error(lens, depths, *other, finer) < 0.01);
  CHECK(std::is_sorted(finer.metres.begin(), finer.metres.end()));
}

TEST_CASE("what is before the focus alone stays within halves") {
  const PixelCoc lens{200.0f, 10.0f};
  const DepthMap depths = ramp(9.0f, 9.9f);
  DepthMap finer = depths;
  const std::optional<PixelCoc> other = with_finer_depths(finer, lens);
  REQUIRE(other);
  CHECK(largest_error(lens, depths, *other, finer) <
        0.5 * largest_error(lens, depths, lens, depths));
}

TEST_CASE("depths stay where it would not help") {
  DepthMap depths = ramp(1.7f, 9.9f);
  CHECK_FALSE(with_finer_depths(depths, {200.0f, 10.0f}));
}

TEST_CASE("depths stay where circles are known well enough, or reach far behind the focus") {
  for (const PixelCoc& lens : {PixelCoc{60.0f, 2.0f}, PixelCoc{500.0f, 2.0f}}) {
    const DepthMap depths = ramp(1.0f, 65504.0f);
    DepthMap same = depths;
    CHECK_FALSE(with_finer_depths(same, lens));
    CHECK(same.metres == depths.metres);
  }
}

#include "scenes/lens_views/samples_by_tile.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "raster/numbers/half.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;

namespace {

// By the definition. NaN counts as above 1.
std::uint64_t squares_of(const std::vector<std::vector<std::uint16_t>>& views) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < views[0].size(); ++i) {
    if (i % 4 == 3) continue;
    float least = 1.0f, most = 0.0f;
    for (const auto& view : views) {
      const float value = half_to_float(view[i]);
      const float in_range = value >= 0.0f ? std::fmin(value, 1.0f) : 0.0f;
      const float seen = std::isnan(value) ? ((view[i] & 0x8000) != 0 ? 0.0f : 1.0f) : in_range;
      least = std::fmin(least, seen);
      most = std::fmax(most, seen);
    }
    const auto brightness = [](float value) {
      return static_cast<std::int64_t>(std::floor(std::sqrt(value) * 4095.0f + 0.5f));
    };
    const std::int64_t apart = brightness(most) - brightness(least);
    sum += static_cast<std::uint64_t>(apart * apart);
  }
  return sum;
}

std::uint64_t found(const std::vector<std::vector<std::uint16_t>>& views) {
  std::vector<const std::uint16_t*> rows;
  rows.reserve(views.size());
  for (const auto& view : views) rows.push_back(view.data());
  return squared_difference(rows, static_cast<int>(views[0].size() / 4));
}

}  // namespace

TEST_CASE("tile difference: the definition's, of any halves and any number of pixels") {
  test::Random random;
  for (const std::size_t pixels : {std::size_t{1}, std::size_t{16}, std::size_t{57}}) {
    for (const bool small : {false, true}) {
      std::vector<std::vector<std::uint16_t>> views(8);
      for (auto& view : views) {
        for (std::size_t i = 0; i < 4 * pixels; ++i) {
          const auto bits = static_cast<std::uint16_t>(random.next());
          view.push_back(small ? static_cast<std::uint16_t>(bits % 0x3C01) : bits);
        }
      }
      CHECK(found(views) == squares_of(views));
    }
  }
}

TEST_CASE("tile difference: equal views and alpha do not differ, black and white do by all") {
  const auto half = [](float value) { return float_to_half(value, HalfRounding::nearest_even); };
  const std::vector<std::uint16_t> black{0, 0, 0, half(1.0f)};
  const std::vector<std::uint16_t> white{half(1.0f), half(7.0f), half(2.0f), half(9.0f)};
  CHECK(found({white, white, white}) == 0);
  CHECK(found({black, {0, 0, 0, 0}}) == 0);
  CHECK(found({black, white}) == 3u * kBrightnessSteps * kBrightnessSteps);
  CHECK(found({white, {half(3.0f), half(1.0f), half(1.5f), 0}}) == 0);
}

#include "scenes/lens_views/tile_difference.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "raster/numbers/half.h"

namespace softfocus {
namespace {

// A half's bits as a signed number: of those from 0 to 1 in their order; what is below 0 is less,
// what is above 1, and NaN, more.
constexpr std::int16_t kOne = 0x3C00;

std::vector<std::int16_t> brightness_table() {
  std::vector<std::int16_t> table;
  for (std::int16_t half = 0; half <= kOne; ++half) {
    const float value = half_to_float(static_cast<std::uint16_t>(half));
    table.push_back(static_cast<std::int16_t>(
        std::floor(std::sqrt(value) * static_cast<float>(kBrightnessSteps) + 0.5f)));
  }
  return table;
}

}  // namespace

std::uint64_t squared_difference(std::span<const std::uint16_t* const> views, int pixels) {
  static const std::vector<std::int16_t> brightness = brightness_table();
  constexpr int kRun = 64;  // halves, of 16 pixels
  std::uint64_t sum = 0;
  for (int begin = 0; begin < 4 * pixels; begin += kRun) {
    const int count = std::min(kRun, 4 * pixels - begin);
    std::array<std::int16_t, kRun> least{}, most{};
    least.fill(kOne);
    for (const std::uint16_t* view : views) {
      for (int i = 0; i < count; ++i) {
        const auto half = static_cast<std::int16_t>(view[begin + i]);
        const auto at = static_cast<std::size_t>(i);
        least[at] = std::min(least[at], half);
        most[at] = std::max(most[at], half);
      }
    }
    for (int i = 0; i < count; ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (i % 4 == 3 || least[at] == most[at]) continue;
      const auto low = static_cast<std::size_t>(std::max<std::int16_t>(least[at], 0));
      const auto high = static_cast<std::size_t>(std::min(most[at], kOne));
      const int apart = brightness[high] - brightness[low];
      sum += static_cast<std::uint64_t>(apart * apart);
    }
  }
  return sum;
}

}  // namespace softfocus

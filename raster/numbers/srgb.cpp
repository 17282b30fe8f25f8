#include "raster/numbers/srgb.h"

#include <algorithm>
#include <array>

#include "raster/numbers/exact_math.h"

namespace softfocus {
namespace {

double decode(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92
                            : exact_math::pow((encoded + 0.055) / 1.055, 2.4);
}

// Entry k is the linear value of sRGB (k + offset)/255.
template <std::size_t Count>
std::array<float, Count> curve(double offset) {
  std::array<float, Count> values{};
  for (std::size_t k = 0; k < Count; ++k) {
    values[k] = static_cast<float>(decode((static_cast<double>(k) + offset) / 255.0));
  }
  return values;
}

}  // namespace

float srgb8_to_linear(std::uint8_t encoded) {
  static const std::array<float, 256> table = curve<256>(0.0);
  return table[encoded];
}

std::uint8_t linear_to_srgb8(float linear) {
  // Where one code gives way to the next: half-way codes, so the search rounds.
  static const std::array<float, 255> thresholds = curve<255>(0.5);
  if (!(linear > 0.0f)) return 0;
  return static_cast<std::uint8_t>(
      std::upper_bound(thresholds.begin(), thresholds.end(), linear) - thresholds.begin());
}

}  // namespace softfocus

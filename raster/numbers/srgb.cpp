#include "raster/numbers/srgb.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "raster/numbers/exact_math.h"

namespace softfocus {
namespace {

double decode(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : exact_math::pow((encoded + 0.055) / 1.055, 2.4);
}

std::array<float, 256> decoding_table() {
  std::array<float, 256> values{};
  for (std::size_t k = 0; k < values.size(); ++k) {
    values[k] = static_cast<float>(decode(static_cast<double>(k) / 255.0));
  }
  return values;
}

// Where one code gives way to the next, half-way between codes: the least floats that
// are not below the curve there.
std::array<float, 255> encoding_thresholds() {
  std::array<float, 255> values{};
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double exact = decode((static_cast<double>(k) + 0.5) / 255.0);
    values[k] = static_cast<float>(exact);
    if (static_cast<double>(values[k]) < exact) values[k] = std::nextafter(values[k], 2.0f);
  }
  return values;
}

}  // namespace

float srgb8_to_linear(std::uint8_t encoded) {
  static const std::array<float, 256> table = decoding_table();
  return table[encoded];
}

std::uint8_t linear_to_srgb8(float linear) {
  static const std::array<float, 255> thresholds = encoding_thresholds();
  if (!(linear > 0.0f)) return 0;
  return static_cast<std::uint8_t>(std::upper_bound(thresholds.begin(), thresholds.end(), linear) -
                                   thresholds.begin());
}

}  // namespace softfocus

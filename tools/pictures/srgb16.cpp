#include "tools/pictures/srgb16.h"

#include "raster/numbers/exact_math.h"
#include "raster/numbers/half.h"

namespace softfocus {

float srgb16_to_linear(std::uint16_t encoded) {
  const double v = encoded / 65535.0;
  return static_cast<float>(v <= 0.04045 ? v / 12.92 : exact_math::pow((v + 0.055) / 1.055, 2.4));
}

std::vector<std::uint16_t> srgb16_of_halves() {
  std::vector<std::uint16_t> encoded(65536, 0);
  for (std::uint32_t bits = 0; bits <= kHalfInfinity; ++bits) {  // negative ones and NaN stay 0
    if (bits >= kHalfOne) {
      encoded[bits] = 65535;
      continue;
    }
    const double linear = static_cast<double>(half_to_float(static_cast<std::uint16_t>(bits)));
    const double v =
        linear <= 0.0031308 ? 12.92 * linear : 1.055 * exact_math::pow(linear, 1.0 / 2.4) - 0.055;
    encoded[bits] = static_cast<std::uint16_t>(v * 65535.0 + 0.5);
  }
  return encoded;
}

}  // namespace softfocus

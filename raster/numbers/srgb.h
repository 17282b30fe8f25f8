#pragma once
// The sRGB transfer curve (IEC 61966-2-1) between linear light and 8 bits.

#include <cmath>
#include <cstdint>

#include "raster/numbers/profile.h"

namespace softfocus {

/// Linear light, 0 to 1, of an 8-bit sRGB value: the curve in binary64, rounded once.
float srgb8_to_linear(std::uint8_t encoded);

/// The same from Mesa's table, which was printed with 8 significant digits: for 26 codes the float
/// beside the nearest.
float srgb8_to_linear_decimal(std::uint8_t encoded);

/// The same in 65280ths: SwiftShader's table, computed in binary32. To nearest, but 149 is one
/// more.
std::uint16_t srgb8_in_65280ths(std::uint8_t encoded);

/// The same by llvmpipe's cubic, up to 1.2e-3 off: encoded / (12.6 * 255) up to 15, above
/// it (k0 + k2 x^2) + x (k1 + k3 x^2) with x = encoded.
float srgb8_to_linear_by_cubic(std::uint8_t encoded, Contraction contraction);

/// The 8-bit sRGB value whose interval holds `linear`: equal to rounding the exact
/// curve to nearest. Below 0 and NaN give 0, above 1 gives 255.
std::uint8_t linear_to_srgb8(float linear);

/// Linear 8 bits: 255 * clamp(value, 0, 1), rounded to nearest; NaN gives 0.
/// half_up: the exact product, ties up; in binary64, as binary32 would round some up to a tie.
/// nearest_even: the product in binary32, ties to even, as drivers compute it.
inline std::uint8_t linear_to_unorm8(float value, UnormRounding rounding = UnormRounding::half_up) {
  if (!(value > 0.0f)) return 0;
  if (value >= 1.0f) return 255;
  if (rounding == UnormRounding::nearest_even) {
    return static_cast<std::uint8_t>(std::nearbyint(value * 255.0f));
  }
  return static_cast<std::uint8_t>(static_cast<double>(value) * 255.0 + 0.5);
}

/// value / 255, correctly rounded.
inline float unorm8_to_linear(std::uint8_t encoded) { return static_cast<float>(encoded) / 255.0f; }

/// value * (1 / 255), both rounded, as drivers compute it: for 126 values another float.
inline float unorm8_by_reciprocal(std::uint8_t encoded) {
  return static_cast<float>(encoded) * (1.0f / 255.0f);
}

}  // namespace softfocus

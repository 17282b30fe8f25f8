#pragma once
// The sRGB transfer curve (IEC 61966-2-1) between linear light and 8 bits.

#include <cstdint>

namespace softfocus {

/// Linear light, 0 to 1, of an 8-bit sRGB value: the curve in binary64, rounded once.
float srgb8_to_linear(std::uint8_t encoded);

/// The 8-bit sRGB value whose interval holds `linear`: equal to rounding the exact
/// curve to nearest. Below 0 and NaN give 0, above 1 gives 255.
std::uint8_t linear_to_srgb8(float linear);

/// Linear 8 bits: round to nearest of 255 * clamp(value, 0, 1), ties up; NaN gives 0.
/// In binary64, where the product is exact: binary32 would round some up to a tie.
inline std::uint8_t linear_to_unorm8(float value) {
  if (!(value > 0.0f)) return 0;
  if (value >= 1.0f) return 255;
  return static_cast<std::uint8_t>(static_cast<double>(value) * 255.0 + 0.5);
}

/// value / 255, correctly rounded.
inline float unorm8_to_linear(std::uint8_t encoded) { return static_cast<float>(encoded) / 255.0f; }

}  // namespace softfocus

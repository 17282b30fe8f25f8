#pragma once
// A frame as a board gets it. The file begins with eight 32-bit words, little-endian. Then
// follows each row from the top: `width` pixels of colour, and `width` codes of depth if alpha is
// not the depth. Code 0 is at near, the largest at far, linear between. All little-endian.

#include <stddef.h>
#include <stdint.h>

namespace softfocus::boards {

enum class FrameFormat : uint32_t {
  rgb565,   ///< 16 bits, red highest; depth of 8 bits
  rgba8,    ///< depth of 16 bits
  rgba16f,  ///< alpha is the depth in metres
};

/// Bytes of a pixel's colour.
constexpr size_t colour_bytes(FrameFormat format) {
  return format == FrameFormat::rgb565 ? 2 : format == FrameFormat::rgba8 ? 4 : 8;
}
constexpr size_t depth_bytes(FrameFormat format) {
  return format == FrameFormat::rgb565 ? 1 : format == FrameFormat::rgba8 ? 2 : 0;
}

struct FrameSettings {
  FrameFormat format;
  uint32_t width;
  uint32_t height;
  uint32_t max_radius_px;
  uint32_t radius_at_infinity_q16;  ///< 1/65536 pixel
  uint32_t focus_um;
  uint32_t near_um;
  uint32_t far_um;
};

// Halves (IEEE 754 binary16: sign, 5 bits of exponent, 10 of fraction) become codes in integers,
// so that every desktop makes the same frame. Rounded to the nearest code, upwards from the
// middle.

/// A half in 1/2^24, the smallest there is: exact. Negative values and NaN are 0,
/// infinity is 2^40, past every other.
constexpr int64_t half_in_q24(uint16_t half) {
  const int exponent = half >> 10 & 31;
  const int64_t fraction = half & 1023;
  if (half > 0x7C00) return 0;
  if (exponent == 31) return int64_t{1} << 40;
  return exponent == 0 ? fraction : (1024 + fraction) << (exponent - 1);
}

/// 0 to 1 as 0 to `largest`, at most 255.
constexpr uint16_t level_of_half(uint16_t half, int largest) {
  constexpr int64_t kOne = 1 << 24;
  const int64_t value = half_in_q24(half);
  return static_cast<uint16_t>(((value < kOne ? value : kOne) * largest + kOne / 2) >> 24);
}

constexpr uint16_t rgb565_of_halves(const uint16_t* rgb) {
  return static_cast<uint16_t>(level_of_half(rgb[0], 31) << 11 | level_of_half(rgb[1], 63) << 5 |
                               level_of_half(rgb[2], 31));
}

/// A depth in metres as 0 at near to `largest`, at most 65535, at far; what lies outside
/// moved to the end.
constexpr uint16_t depth_code_of_half(uint16_t half, uint32_t near_um, uint32_t far_um,
                                      int largest) {
  // At most 2^40 / 2^4 * 10^6: below 2^56.
  const int64_t depth_um = (half_in_q24(half) >> 4) * 1000000 >> 20;
  if (depth_um <= near_um) return 0;
  if (depth_um >= far_um) return static_cast<uint16_t>(largest);
  const int64_t range = int64_t{far_um} - near_um;
  return static_cast<uint16_t>(((depth_um - near_um) * largest + range / 2) / range);
}

}  // namespace softfocus::boards

#pragma once
// Window positions in fixed point. A position counts 1/256 pixel (8 fractional
// bits), measured from the centre of pixel (0, 0): pixel (x, y) has its centre at
// exactly (256 x, 256 y), so an edge function at a pixel centre has no fraction.

#include <cmath>
#include <cstdint>
#include <limits>

namespace softfocus {

// Floats to 32-bit integers as x86 vector units convert them (Intel's manual, CVTTPS2DQ and
// CVTPS2DQ): values that do not fit, NaN too, become the least integer. C++ leaves such
// conversions undefined, and other CPUs saturate.

/// The integer part.
inline std::int32_t truncate_to_int(float value) {
  if (!(value >= -0x1p31f && value < 0x1p31f)) return std::numeric_limits<std::int32_t>::min();
  return static_cast<std::int32_t>(value);
}

/// The nearest integer, ties to even.
inline std::int32_t round_to_int(float value) { return truncate_to_int(std::nearbyint(value)); }

inline constexpr int kSubpixelBits = 8;
inline constexpr std::int32_t kSubpixelOne = 1 << kSubpixelBits;

/// Snaps a window coordinate in pixels (pixel 0 spans 0 to 1) to the grid:
/// round-to-nearest-even of (coordinate - 0.5) * 256, both operations in binary32.
/// Needs |coordinate| <= 2^22; the guard band sees to that.
inline std::int32_t snap_to_subpixel(float window_coordinate) {
  return static_cast<std::int32_t>(
      std::lrint((window_coordinate - 0.5f) * static_cast<float>(kSubpixelOne)));
}

/// The window coordinate in pixels of a snapped one; exact while |snapped| < 2^23.
inline float subpixel_to_window(std::int32_t snapped) {
  return static_cast<float>(snapped) * (1.0f / kSubpixelOne) + 0.5f;
}

}  // namespace softfocus

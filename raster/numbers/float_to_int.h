#pragma once
// Floats to 32-bit integers as x86 vector units convert them (Intel's manual, CVTTPS2DQ and
// CVTPS2DQ): values that do not fit, NaN too, become the least integer. C++ leaves such
// conversions undefined, and other CPUs saturate.

#include <cmath>
#include <cstdint>
#include <limits>

namespace softfocus {

/// The integer part.
inline std::int32_t truncate_to_int(float value) {
  if (!(value >= -0x1p31f && value < 0x1p31f)) return std::numeric_limits<std::int32_t>::min();
  return static_cast<std::int32_t>(value);
}

/// The nearest integer, ties to even.
inline std::int32_t round_to_int(float value) { return truncate_to_int(std::nearbyint(value)); }

}  // namespace softfocus

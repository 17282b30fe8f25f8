#pragma once
// The weights of dof/weights.h in integers. A weight is Q0.19: 2^19 is 1.
//
// Sums stay within 32 bits. A neighbour at distance d weighs at most 2^19 / (d + 1)^2 + 1,
// whatever its radius: its overlap is 0 up to radius d, and (r - d) / r^2 grows up to
// r = d + 1. Both sides and the centre together weigh at most
// 2^19 (2 pi^2 / 6 - 1) + 126 = 1,200,701 < 2^20.2; times a colour of 10 bits, less than
// 2^30.2.
//
// A receiver's leakage L multiplies the sums of all neighbours beyond the focus at once:
// floor(sum L). The floor changes the quotient by less than colour / weight. That is half a step
// at most if the receiver weighs 2^11 or more where 0 < L < 1, as it does with a leak factor of
// 1/16 or more: its radius is then below 16. So a constant picture stays constant.

#include <stdint.h>

#include "dof/fixed/softfocus_fixed.h"

namespace softfocus::fixed {

using Weights = softfocus_fixed_weights;

inline constexpr int kWeightBits = 19;
inline constexpr uint32_t kOne = 1u << kWeightBits;
inline constexpr int kLeakBits = 15;
inline constexpr uint32_t kLeakOne = 1u << kLeakBits;
inline constexpr uint32_t kLeastLeak = 4096;         // of a lens, Q16.16, if it is not 0
inline constexpr uint32_t kLeastLeaking = 1u << 11;  // a receiver's least weight if 0 < L < 1
inline constexpr int kRadiusBits = 16;
inline constexpr uint32_t kLargestRadius = (SOFTFOCUS_FIXED_LARGEST_REACH + 1u) << kRadiusBits;

inline constexpr uint32_t kHalfInfinity = 0x7C00;
inline constexpr uint32_t kHalfLargest = 0x7BFF;

constexpr uint64_t smaller(uint64_t a, uint64_t b) { return a < b ? a : b; }

/// The value of a finite half without its sign, in units of 2^-24: below 2^40, exact.
constexpr uint64_t half_magnitude(uint32_t magnitude) {
  const uint32_t exponent = magnitude >> 10;
  const uint32_t mantissa = magnitude & 0x3FFu;
  return exponent == 0 ? mantissa : static_cast<uint64_t>(mantissa | 0x400u) << (exponent - 1);
}

/// Weights of a pixel whose circle has that radius, Q16.16 up to kLargestRadius; `leak` is
/// the lens's. Every quotient and product is rounded to nearest, ties up.
Weights make_weights(uint64_t radius, uint32_t leak, bool beyond);

/// Whether sums of such weights stay within their bounds, and taps within `reach`. True of
/// everything that make_weights() makes.
bool within_bounds(const Weights& weights, uint32_t reach);

}  // namespace softfocus::fixed

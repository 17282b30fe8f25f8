#include "dof/fixed/weights.h"

#include "dof/fixed/wide.h"

namespace softfocus::fixed {

Weights make_weights(uint64_t radius, uint32_t leak, bool beyond) {
  constexpr uint64_t kPixel = uint64_t{1} << kRadiusBits;
  const uint64_t square = radius > kPixel ? radius * radius : kPixel * kPixel;
  const uint64_t whole = multiply_divide(1, uint64_t{1} << (kWeightBits + 2 * kRadiusBits), square);
  const uint64_t reach = radius > 0 ? (radius - 1) >> kRadiusBits : 0;
  const uint64_t part = radius - (reach << kRadiusBits);  // above 0, up to a pixel
  const uint64_t edge = reach > 0 ? (whole * part + kPixel / 2) >> kRadiusBits : whole;
  // Below 2^32 2^22 = 2^54 before it is rounded from Q.32 to Q.15.
  constexpr int kCut = 2 * kRadiusBits - kLeakBits;
  const uint64_t taken = (leak * radius + (uint64_t{1} << (kCut - 1))) >> kCut;
  return {static_cast<uint32_t>(whole), static_cast<uint32_t>(edge),
          static_cast<uint16_t>(smaller(taken, kLeakOne)), static_cast<uint8_t>(reach),
          static_cast<uint8_t>(beyond ? 1 : 0)};
}

bool within_bounds(const Weights& weights, uint32_t reach) {
  const uint32_t square = uint32_t{weights.reach} * weights.reach;
  const uint32_t next = (weights.reach + 1u) * (weights.reach + 1u);
  return weights.reach <= reach && weights.whole >= 1 && weights.whole <= kOne &&
         weights.edge <= weights.whole && weights.leak <= kLeakOne && weights.beyond <= 1 &&
         (weights.reach > 0 || weights.edge == weights.whole) &&
         (weights.leak == 0 || weights.leak == kLeakOne || weights.whole >= kLeastLeaking) &&
         // 2^19 2^12 < 2^31. To distance reach - 1: 2^19 / reach^2 + 1/2.
         weights.whole * square <= kOne + square / 2 && weights.edge * next <= kOne + next;
}

}  // namespace softfocus::fixed

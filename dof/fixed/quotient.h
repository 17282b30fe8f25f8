#pragma once
// floor(sum / weight), exact and without a division: by a reciprocal that is too small by less
// than a step of the quotient, and a look at the remainder. One reciprocal serves the three
// channels of a pixel.
//
// The weight is shifted to W in [2^20, 2^21).
//   first   r0 = table[W >> 14], floor(2^14 / (i + 65)) for W in [i + 64, i + 65) 2^14: at
//           most 2^28 / W, and below it by at most 1/65 + 1/127 = 2.33 % of it
//   Newton  r = r0 (2^29 - W r0) ~ 2^57 / W, in error by the square of that, downwards:
//           0.054 %; cut to 2^36 / W, in two cuts of less than 2^-15 each
//   then    (sum >> 15) r >> 21 with the sum shifted like the weight, below 1024 2^21:
//           below the quotient by less than 1023.5 (0.054 % + 2 2^-15) + 2^-5 + 1 < 2
// so the result is the quotient or one less.

#include <stdint.h>

#include "dof/fixed/weights.h"

namespace softfocus::fixed {

inline constexpr int kReciprocalBits = 6;

struct ReciprocalTable {
  uint8_t of[1 << kReciprocalBits];
};
constexpr ReciprocalTable make_reciprocals() {
  ReciprocalTable table{};
  for (uint32_t i = 0; i < 1u << kReciprocalBits; ++i) {
    table.of[i] = static_cast<uint8_t>((1u << 14) / (i + 65u));
  }
  return table;
}
inline constexpr ReciprocalTable kReciprocals = make_reciprocals();

struct Divisor {
  uint32_t weight;  // in [2^20, 2^21)
  uint32_t reciprocal;
  int shift;
};

/// Shifts a weight up by `step` if its upper `step` bits, of 21, are 0.
template <int step>
inline void normalise(uint32_t& weight, int& shift) {
  if (weight >> (21 - step) != 0) return;
  weight <<= step;
  shift += step;
}

/// For a weight that lies in [2^20, 2^21) when shifted.
inline Divisor make_divisor(uint32_t weight, int shift) {
  weight <<= shift;
  const uint32_t first = kReciprocals.of[(weight >> 14) - 64u];
  const uint32_t second = ((((1u << 29) - weight * first) >> 13) * first) >> 7;
  return {weight, second, shift};
}

/// `weight` from 1 to 2^21 - 1.
inline Divisor make_divisor(uint32_t weight) {
  uint32_t shifted = weight;
  int shift = 0;
  normalise<16>(shifted, shift);
  normalise<8>(shifted, shift);
  normalise<4>(shifted, shift);
  normalise<2>(shifted, shift);
  normalise<1>(shifted, shift);
  return make_divisor(weight, shift);
}

/// floor(sum / weight), up to 1023. Needs sum < 1024 weight.
inline uint32_t quotient(uint32_t sum, const Divisor& divisor) {
  const uint32_t shifted = sum << divisor.shift;  // below 2^31
  uint32_t result = ((shifted >> 15) * divisor.reciprocal) >> 21;
  if (shifted - result * divisor.weight >= divisor.weight) ++result;
  return result;
}

}  // namespace softfocus::fixed

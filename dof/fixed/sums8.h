#pragma once
// Colours of 10 bits and their weighted sums. Between the passes a colour is Q8.2 of 255,
// and the three of a pixel lie in one word: red in the lowest bits.

#include "dof/fixed/quotient.h"
#include "dof/fixed/weights.h"

namespace softfocus::fixed {

inline constexpr int kColourBits = 10;
inline constexpr uint32_t kColourMask = (1u << kColourBits) - 1;

constexpr uint32_t pack(uint32_t r, uint32_t g, uint32_t b) {
  return r | g << kColourBits | b << (2 * kColourBits);
}

constexpr uint32_t red(uint32_t colour) { return colour & kColourMask; }
constexpr uint32_t green(uint32_t colour) { return colour >> kColourBits & kColourMask; }
constexpr uint32_t blue(uint32_t colour) { return colour >> (2 * kColourBits); }

/// Modulo 2^32, so that weights can be subtracted too; whole sums fit (weights.h).
struct Sums {
  uint32_t weight, r, g, b;
};

constexpr Sums weighted(uint32_t colour, uint32_t weight) {
  return {weight, red(colour) * weight, green(colour) * weight, blue(colour) * weight};
}

// These are not inlined: among many live values they are longer and slower on CPUs with few
// registers.

[[gnu::noinline]] inline void add(Sums& sums, uint32_t colour, uint32_t weight) {
  const Sums more = weighted(colour, weight);
  sums.weight += more.weight;
  sums.r += more.r;
  sums.g += more.g;
  sums.b += more.b;
}

/// Adds to one sum and subtracts from another.
[[gnu::noinline]] inline void add_and_subtract(Sums& to, Sums& from, uint32_t colour,
                                               uint32_t weight) {
  const Sums more = weighted(colour, weight);
  to.weight += more.weight;
  from.weight -= more.weight;
  to.r += more.r;
  from.r -= more.r;
  to.g += more.g;
  from.g -= more.g;
  to.b += more.b;
  from.b -= more.b;
}

/// floor(sum leak), leak Q1.15, in 32 bits.
constexpr uint32_t leaked(uint32_t sum, uint32_t leak) {
  constexpr uint32_t kLow = kLeakOne - 1;
  return (sum >> kLeakBits) * leak + (((sum & kLow) * leak) >> kLeakBits);
}

/// What a receiver takes of all sums. `beyond` is the part of them from beyond the focus.
inline Sums keep_leaked(const Sums& all, const Sums& beyond, uint32_t leak) {
  return {all.weight - beyond.weight + leaked(beyond.weight, leak),
          all.r - beyond.r + leaked(beyond.r, leak), all.g - beyond.g + leaked(beyond.g, leak),
          all.b - beyond.b + leaked(beyond.b, leak)};
}

/// The last divisor, for the next pixel: where depth is constant the weight is the same, and
/// elsewhere it often needs the same shift.
struct LastDivisor {
  uint32_t weight;  ///< 0: none yet
  Divisor divisor;

  const Divisor& of(uint32_t sum) {
    if (sum != weight) {
      weight = sum;
      divisor =
          sum >> (20 - divisor.shift) == 1 ? make_divisor(sum, divisor.shift) : make_divisor(sum);
    }
    return divisor;
  }
};

}  // namespace softfocus::fixed

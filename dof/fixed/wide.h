#pragma once
// Products and quotients of more than 64 bits, a bit at a time: for work that is done once a
// lens, on CPUs that may have no division.

#include <stdint.h>

namespace softfocus::fixed {

struct Wide {
  uint64_t high, low;
};

constexpr Wide multiply(uint64_t a, uint64_t b) {
  const uint64_t a_low = a & 0xFFFFFFFFu, a_high = a >> 32;
  const uint64_t b_low = b & 0xFFFFFFFFu, b_high = b >> 32;
  const uint64_t low = a_low * b_low;
  const uint64_t middle = a_high * b_low + (low >> 32);  // below 2^64: (2^32-1)^2 + 2^32-1
  const uint64_t other = a_low * b_high + (middle & 0xFFFFFFFFu);
  return {a_high * b_high + (middle >> 32) + (other >> 32), other << 32 | (low & 0xFFFFFFFFu)};
}

constexpr Wide add(Wide a, uint64_t b) {
  const uint64_t low = a.low + b;
  return {a.high + (low < b ? 1u : 0u), low};
}

/// floor(a / divisor), or 2^64 - 1 if that is less. A divisor of 0 gives 2^64 - 1 too.
[[gnu::noinline]] constexpr uint64_t divide(Wide a, uint64_t divisor) {
  if (a.high >= divisor) return UINT64_MAX;
#if UINTPTR_MAX > 0xFFFFFFFF
  if (a.high == 0) return a.low / divisor;  // where a CPU has this as an instruction
#endif
  uint64_t remainder = a.high;  // below the divisor
  uint64_t rest = a.low;        // bits of `a` to come, above bits of the quotient
  int steps = 64;
  for (; a.high == 0 && steps > 8 && rest >> 56 == 0; steps -= 8) rest <<= 8;
  for (; steps > 0; --steps) {
    const bool carry = (remainder >> 63) != 0;
    remainder = remainder << 1 | rest >> 63;
    rest <<= 1;
    if (carry || remainder >= divisor) {
      remainder -= divisor;  // modulo 2^64 if there was a carry
      rest |= 1u;
    }
  }
  return rest;
}

/// a b / divisor to the nearest integer, ties up.
[[gnu::noinline]] constexpr uint64_t multiply_divide(uint64_t a, uint64_t b, uint64_t divisor) {
  return divide(add(multiply(a, b), divisor >> 1), divisor);
}

}  // namespace softfocus::fixed

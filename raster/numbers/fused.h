#pragma once
// a b + c, rounded once.

#include <bit>
#include <cmath>
#include <cstdint>

namespace softfocus {

/// In binary64 the product is exact. The sum is rounded to odd: an inexact one becomes its
/// neighbour whose last bit is 1. Rounded to binary32 it gives the same as the exact sum (Boldo and
/// Melquiond 2008, "Emulation of a FMA and correctly rounded sums: proved algorithms using
/// rounding to odd").
inline float fused_by_rounding_to_odd(float a, float b, float c) {
  const double product = static_cast<double>(a) * static_cast<double>(b);
  const auto addend = static_cast<double>(c);
  const double sum = product + addend;
  // The sum's rounding error, exact (Knuth's TwoSum). NaN if it overflowed.
  const double part = sum - product;
  const double error = (product - (sum - part)) + (addend - part);
  auto bits = std::bit_cast<std::uint64_t>(sum);
  if ((bits & 1u) == 0 && (error > 0.0 || error < 0.0)) {
    (error > 0.0) == (sum > 0.0) ? ++bits : --bits;
  }
  return static_cast<float>(std::bit_cast<double>(bits));
}

/// The fused operation of profiles: the processor's, or the C library's if that is known to round
/// once. mingw-w64's and musl's for WebAssembly do not.
inline float fused_multiply_add(float a, float b, float c) {
#if defined(__FP_FAST_FMAF) || defined(__GLIBC__)
  return std::fma(a, b, c);
#else
  return fused_by_rounding_to_odd(a, b, c);
#endif
}

}  // namespace softfocus

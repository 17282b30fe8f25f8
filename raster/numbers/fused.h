#pragma once
// a b + c, rounded once.

#include <bit>
#include <cmath>
#include <cstdint>

namespace softfocus {

/// In binary64, where the product is exact and the sum is rounded to odd: of the two
/// neighbours of an inexact sum, the one whose last bit is 1. Rounding that to binary32
/// gives what rounding the exact sum would (Boldo and Melquiond 2008, "Emulation of a FMA
/// and correctly rounded sums: proved algorithms using rounding to odd").
inline float fused_by_rounding_to_odd(float a, float b, float c) {
  const double product = static_cast<double>(a) * static_cast<double>(b);
  const auto addend = static_cast<double>(c);
  const double sum = product + addend;
  // What rounding took off the sum, exactly (Knuth's TwoSum). NaN if it overflowed.
  const double part = sum - product;
  const double error = (product - (sum - part)) + (addend - part);
  auto bits = std::bit_cast<std::uint64_t>(sum);
  if ((bits & 1u) == 0 && (error > 0.0 || error < 0.0)) {
    (error > 0.0) == (sum > 0.0) ? ++bits : --bits;
  }
  return static_cast<float>(std::bit_cast<double>(bits));
}

/// The fused operation of profiles: the processor's, or the C library's where that is
/// known to round once. mingw-w64's and musl's for WebAssembly do not.
inline float fused_multiply_add(float a, float b, float c) {
#if defined(__FP_FAST_FMAF) || defined(__GLIBC__)
  return std::fma(a, b, c);
#else
  return fused_by_rounding_to_odd(a, b, c);
#endif
}

}  // namespace softfocus

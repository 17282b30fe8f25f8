#pragma once
// The transcendental functions that scenes and projections need, made of IEEE
// binary64 + - * / in a fixed order, so that they give the same bits on every
// machine. The C library's do not: glibc, musl, MSVC and newlib differ in last bits.

namespace softfocus::exact_math {

inline constexpr double kPi = 3.14159265358979323846;

/// Sine and cosine of an angle in degrees. Multiples of 90 give exactly 0, 1 and
/// -1. Error below 2 units in the last place. NaN for an infinite or NaN angle.
double sin_degrees(double degrees);
double cos_degrees(double degrees);

/// sin_degrees / cos_degrees: at odd multiples of 90 a division by zero, infinity.
double tan_degrees(double degrees);

/// 2^x; error below 2 units in the last place; 0 and infinity past the range.
double exp2(double x);

/// Binary logarithm; -infinity for 0, NaN for negative x. Error below 4 units in the
/// last place, near 1 too.
double log2(double x);

/// exp2(y * log2(x)) for x >= 0; relative error below 1e-13 where the result lies
/// between 2^-64 and 2^64. pow(0, 0) is 1.
double pow(double x, double y);

}  // namespace softfocus::exact_math

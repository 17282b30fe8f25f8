#include "raster/numbers/exact_math.h"

#include <cmath>
#include <limits>

// Taylor and atanh series cut where the next term falls below 2^-56 of the result
// on the reduced range. Their coefficients are plain fractions, so the compiler
// rounds each one correctly and nothing has to be taken on trust.

namespace softfocus::exact_math {
namespace {

// |x| <= pi/4, radians.
double sin_kernel(double x) {
  const double square = x * x;
  double sum = 1.0 / 355687428096000.0;  // 1/17!
  sum = sum * square - 1.0 / 1307674368000.0;
  sum = sum * square + 1.0 / 6227020800.0;
  sum = sum * square - 1.0 / 39916800.0;
  sum = sum * square + 1.0 / 362880.0;
  sum = sum * square - 1.0 / 5040.0;
  sum = sum * square + 1.0 / 120.0;
  sum = sum * square - 1.0 / 6.0;
  return x + x * (square * sum);
}

double cos_kernel(double x) {
  const double square = x * x;
  double sum = 1.0 / 20922789888000.0;  // 1/16!
  sum = sum * square - 1.0 / 87178291200.0;
  sum = sum * square + 1.0 / 479001600.0;
  sum = sum * square - 1.0 / 3628800.0;
  sum = sum * square + 1.0 / 40320.0;
  sum = sum * square - 1.0 / 720.0;
  sum = sum * square + 1.0 / 24.0;
  return 1.0 - square * (0.5 - square * sum);
}

// An angle as a number of quarter turns (0 to 3) and a rest in [-45, 45] degrees,
// exact: fmod is, and so is the subtraction of a nearby multiple of 90.
struct Quadrant {
  int quarter;
  double rest_radians;
};

Quadrant reduce(double degrees) {
  const double turn = std::fmod(degrees, 360.0);
  const double quarters = std::floor(turn / 90.0 + 0.5);
  const double rest = turn - quarters * 90.0;
  const int quarter = std::isfinite(quarters) ? static_cast<int>(quarters) & 3 : 0;
  return {quarter, rest * (kPi / 180.0)};
}

}  // namespace

double sin_degrees(double degrees) {
  const Quadrant angle = reduce(degrees);
  const double value =
      (angle.quarter & 1) != 0 ? cos_kernel(angle.rest_radians) : sin_kernel(angle.rest_radians);
  return (angle.quarter & 2) != 0 ? -value : value;
}

double cos_degrees(double degrees) {
  const Quadrant angle = reduce(degrees);
  const double value =
      (angle.quarter & 1) != 0 ? -sin_kernel(angle.rest_radians) : cos_kernel(angle.rest_radians);
  return (angle.quarter & 2) != 0 ? -value : value;
}

double tan_degrees(double degrees) { return sin_degrees(degrees) / cos_degrees(degrees); }

double exp2(double x) {
  if (std::isnan(x)) return x;
  if (x > 1100.0) return std::numeric_limits<double>::infinity();
  if (x < -1200.0) return 0.0;
  const double whole = std::floor(x + 0.5);
  const double t = (x - whole) * 0.693147180559945309417;  // ln 2; |t| <= 0.347
  double sum = 1.0 / 6227020800.0;                         // 1/13!
  sum = sum * t + 1.0 / 479001600.0;
  sum = sum * t + 1.0 / 39916800.0;
  sum = sum * t + 1.0 / 3628800.0;
  sum = sum * t + 1.0 / 362880.0;
  sum = sum * t + 1.0 / 40320.0;
  sum = sum * t + 1.0 / 5040.0;
  sum = sum * t + 1.0 / 720.0;
  sum = sum * t + 1.0 / 120.0;
  sum = sum * t + 1.0 / 24.0;
  sum = sum * t + 1.0 / 6.0;
  sum = sum * t + 0.5;
  return std::ldexp(1.0 + (t + t * t * sum), static_cast<int>(whole));
}

double log2(double x) {
  if (std::isnan(x) || x < 0.0) return std::numeric_limits<double>::quiet_NaN();
  if (x == 0.0) return -std::numeric_limits<double>::infinity();
  if (std::isinf(x)) return x;
  int exponent = 0;
  double mantissa = std::frexp(x, &exponent);  // [0.5, 1)
  if (mantissa < 0.70710678118654752440) {
    mantissa *= 2.0;
    --exponent;
  }
  // ln m = 2 atanh(s), |s| <= 0.172
  const double s = (mantissa - 1.0) / (mantissa + 1.0);
  const double square = s * s;
  double sum = 1.0 / 23.0;
  for (int odd = 21; odd >= 3; odd -= 2) sum = sum * square + 1.0 / odd;
  const double ln = 2.0 * (s + s * (square * sum));
  return exponent + ln * 1.44269504088896340736;
}

double pow(double x, double y) {
  if (y == 0.0) return 1.0;
  return exp2(y * log2(x));
}

}  // namespace softfocus::exact_math

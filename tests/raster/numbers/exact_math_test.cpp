#include "raster/numbers/exact_math.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cfloat>
#include <cmath>
#include <limits>

#include "raster/numbers/hash.h"
#include "tests/support/raster_helpers.h"

// The oracle is the C library in long double. If that has 64 bits of mantissa (x86), the documented
// bounds are tested. Else it may be no better than binary64 itself, and twice the bound is allowed
// for.

using namespace softfocus;

namespace {

constexpr bool kGoodOracle = LDBL_MANT_DIG >= 64;
constexpr double kSlack = kGoodOracle ? 1.0 : 2.0;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

void tell_oracle() {
  if (!kGoodOracle) MESSAGE("long double is narrow here: bounds are doubled");
}

// |value - exact| in units of the last place of the exact value.
double error_ulps(double value, long double exact) {
  const auto rounded = static_cast<double>(exact);
  const double magnitude = std::fabs(rounded);
  const double ulp = std::nextafter(magnitude, kInfinity) - magnitude;
  return static_cast<double>(std::fabs(static_cast<long double>(value) - exact) /
                             static_cast<long double>(ulp));
}

constexpr long double kPiLong = 3.14159265358979323846264338327950288L;

// The angle's rest within 45 degrees of a multiple of 90 is exact; the rest is the library's.
long double sin_oracle(double degrees) {
  int quarter = 0;
  const double rest = std::remquo(degrees, 90.0, &quarter);
  const long double radians = static_cast<long double>(rest) * (kPiLong / 180.0L);
  switch (quarter & 3) {
    case 0: return std::sin(radians);
    case 1: return std::cos(radians);
    case 2: return -std::sin(radians);
    default: return -std::cos(radians);
  }
}
// cos by the same reduction: adding 90 to the angle would round.
long double cos_oracle(double degrees) {
  int quarter = 0;
  const double rest = std::remquo(degrees, 90.0, &quarter);
  const long double radians = static_cast<long double>(rest) * (kPiLong / 180.0L);
  switch (quarter & 3) {
    case 0: return std::cos(radians);
    case 1: return -std::sin(radians);
    case 2: return -std::cos(radians);
    default: return std::sin(radians);
  }
}

// Angles of all sizes, near multiples of 90 among them.
double some_angle(test::Random& random, int i) {
  switch (i % 4) {
    case 0: return random.between(-45.0, 45.0);
    case 1: return random.between(-720.0, 720.0);
    case 2: return random.between(-1e9, 1e9);
    default: {
      // One at a time: the order in which operands draw numbers is the compiler's choice.
      const double multiple = 90.0 * random.whole(-40, 40);
      const int exponent = random.whole(-50, 5);
      return multiple + std::ldexp(random.between(-1.0, 1.0), exponent);
    }
  }
}

constexpr int kTries = 100'000;

}  // namespace

TEST_CASE("sine and cosine in degrees are within 2 units in the last place") {
  tell_oracle();
  test::Random random{11};
  double worst_sin = 0.0;
  double worst_cos = 0.0;
  for (int i = 0; i < kTries; ++i) {
    const double angle = some_angle(random, i);
    if (angle == 0.0) continue;
    worst_sin = std::max(worst_sin, error_ulps(exact_math::sin_degrees(angle), sin_oracle(angle)));
    worst_cos = std::max(worst_cos, error_ulps(exact_math::cos_degrees(angle), cos_oracle(angle)));
  }
  CHECK(worst_sin < 2.0 * kSlack);
  CHECK(worst_cos < 2.0 * kSlack);
}

TEST_CASE("multiples of 90 degrees have sines and cosines of exactly 0, 1 and -1") {
  int wrong = 0;
  for (int quarter = -4000; quarter <= 4000; ++quarter) {
    const double angle = 90.0 * quarter;
    const int turn = quarter & 3;
    const double sine = turn == 1 ? 1.0 : turn == 3 ? -1.0 : 0.0;
    const double cosine = turn == 0 ? 1.0 : turn == 2 ? -1.0 : 0.0;
    wrong += exact_math::sin_degrees(angle) != sine;
    wrong += exact_math::cos_degrees(angle) != cosine;
  }
  CHECK(wrong == 0);
}

TEST_CASE("sine is odd and cosine is even, to the bit") {
  test::Random random{12};
  int wrong = 0;
  for (int i = 0; i < kTries; ++i) {
    const double angle = some_angle(random, i);
    wrong += exact_math::sin_degrees(-angle) != -exact_math::sin_degrees(angle);
    wrong += exact_math::cos_degrees(-angle) != exact_math::cos_degrees(angle);
  }
  CHECK(wrong == 0);
}

TEST_CASE("sine and cosine of an infinite or NaN angle are NaN") {
  for (const double angle : {kInfinity, -kInfinity, std::numeric_limits<double>::quiet_NaN()}) {
    CHECK(std::isnan(exact_math::sin_degrees(angle)));
    CHECK(std::isnan(exact_math::cos_degrees(angle)));
    CHECK(std::isnan(exact_math::tan_degrees(angle)));
  }
}

TEST_CASE("the tangent is within 5 units in the last place, and infinite at 90 degrees") {
  // Two functions of 2 each and a division of 1/2.
  test::Random random{13};
  double worst = 0.0;
  for (int i = 0; i < kTries; ++i) {
    const double angle = some_angle(random, i);
    if (std::fmod(angle, 90.0) == 0.0) continue;
    worst = std::max(
        worst, error_ulps(exact_math::tan_degrees(angle), sin_oracle(angle) / cos_oracle(angle)));
  }
  CHECK(worst < 5.0 * kSlack);
  CHECK(std::isinf(exact_math::tan_degrees(90.0)));
  CHECK(std::isinf(exact_math::tan_degrees(-270.0)));
}

TEST_CASE("exp2 is within 2 units in the last place") {
  tell_oracle();
  test::Random random{14};
  double worst = 0.0;
  for (int i = 0; i < kTries; ++i) {
    const double x = i % 2 == 0 ? random.between(-1074.0, 1024.0) : random.between(-2.0, 2.0);
    worst =
        std::max(worst, error_ulps(exact_math::exp2(x), std::exp2(static_cast<long double>(x))));
  }
  CHECK(worst < 2.0 * kSlack);
}

TEST_CASE("exp2 of a whole number is exact, subnormal results included") {
  int wrong = 0;
  for (int k = -1074; k < 1024; ++k) wrong += exact_math::exp2(k) != std::ldexp(1.0, k);
  CHECK(wrong == 0);
}

TEST_CASE("exp2 ends in 0 and infinity past the range, and keeps NaN") {
  for (const double x : {-1076.0, -1e5, -kInfinity}) CHECK(exact_math::exp2(x) == 0.0);
  for (const double x : {1024.0, 1e5, kInfinity}) CHECK(exact_math::exp2(x) == kInfinity);
  CHECK(std::isnan(exact_math::exp2(std::numeric_limits<double>::quiet_NaN())));
}

TEST_CASE("log2 is within 4 units in the last place, near 1 too") {
  tell_oracle();
  test::Random random{15};
  double worst = 0.0;
  for (int i = 0; i < kTries; ++i) {
    double x = random.between(0.5, 2.0);
    if (i % 3 == 1) x = std::ldexp(x, random.whole(-1070, 1022));
    if (i % 3 == 2) x = 1.0 + std::ldexp(random.between(-1.0, 1.0), random.whole(-52, -2));
    if (x == 1.0) continue;
    worst =
        std::max(worst, error_ulps(exact_math::log2(x), std::log2(static_cast<long double>(x))));
  }
  CHECK(worst < 4.0 * kSlack);
}

TEST_CASE("log2 of a power of two is exact, subnormals included") {
  int wrong = 0;
  for (int k = -1074; k < 1024; ++k) wrong += exact_math::log2(std::ldexp(1.0, k)) != k;
  CHECK(wrong == 0);
}

TEST_CASE("log2 is -infinity at 0, NaN below, and keeps infinity and NaN") {
  CHECK(exact_math::log2(0.0) == -kInfinity);
  CHECK(std::isnan(exact_math::log2(-1.0)));
  CHECK(std::isnan(exact_math::log2(-kInfinity)));
  CHECK(exact_math::log2(kInfinity) == kInfinity);
  CHECK(std::isnan(exact_math::log2(std::numeric_limits<double>::quiet_NaN())));
}

TEST_CASE("pow has a relative error below 1e-13 where results lie between 2^-64 and 2^64") {
  tell_oracle();
  test::Random random{16};
  double worst = 0.0;
  for (int i = 0; i < kTries; ++i) {
    const double x = std::ldexp(random.between(1.0, 2.0), random.whole(-20, 20));
    const double limit = 64.0 / std::max(0.01, std::fabs(std::log2(x)));
    const double y = random.between(-limit, limit);
    const long double exact = std::pow(static_cast<long double>(x), static_cast<long double>(y));
    if (exact < 0x1p-64L || exact > 0x1p64L) continue;
    const long double error = static_cast<long double>(exact_math::pow(x, y)) / exact - 1.0L;
    worst = std::max(worst, std::fabs(static_cast<double>(error)));
  }
  CHECK(worst < 1e-13);
}

TEST_CASE("pow of anything to 0 is 1, of 0 to a positive power 0") {
  for (const double x : {0.0, 0.3, 1.0, 1e300}) CHECK(exact_math::pow(x, 0.0) == 1.0);
  for (const double y : {0.1, 1.0, 50.0}) CHECK(exact_math::pow(0.0, y) == 0.0);
}

TEST_CASE("the deterministic functions give the same bits in every build") {
  test::Random random{17};
  Hash hash;
  for (int i = 0; i < 20'000; ++i) {
    const double angle = some_angle(random, i);
    const double x = random.between(-30.0, 30.0);
    for (const double value :
         {exact_math::sin_degrees(angle), exact_math::cos_degrees(angle), exact_math::exp2(x),
          exact_math::log2(std::fabs(x)), exact_math::pow(std::fabs(x), 2.4)}) {
      add_to_hash(hash, std::bit_cast<std::uint64_t>(value));
    }
  }
  CHECK(hash.value == 12310454275118899437u);
}

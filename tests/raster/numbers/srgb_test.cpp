#include "raster/numbers/srgb.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include "tests/support/raster_helpers.h"

using namespace softfocus;

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// IEC 61966-2-1 in long double with the C library's power.
long double curve(long double encoded) {
  return encoded <= 0.04045L ? encoded / 12.92L : std::pow((encoded + 0.055L) / 1.055L, 2.4L);
}

std::uint8_t code(int value) { return static_cast<std::uint8_t>(value); }

}  // namespace

TEST_CASE("sRGB decodes to the curve, rounded once") {
  int wrong = 0;
  for (int k = 0; k < 256; ++k) {
    const auto expected = static_cast<float>(curve(static_cast<long double>(k) / 255.0L));
    wrong += srgb8_to_linear(code(k)) != expected;
  }
  CHECK(wrong == 0);
}

TEST_CASE("sRGB decoding runs from 0 to 1 and rises with every code") {
  CHECK(srgb8_to_linear(0) == 0.0f);
  CHECK(srgb8_to_linear(255) == 1.0f);
  int wrong = 0;
  for (int k = 0; k < 255; ++k) wrong += srgb8_to_linear(code(k)) >= srgb8_to_linear(code(k + 1));
  CHECK(wrong == 0);
}

TEST_CASE("every sRGB code survives decoding and encoding") {
  int wrong = 0;
  for (int k = 0; k < 256; ++k) wrong += linear_to_srgb8(srgb8_to_linear(code(k))) != k;
  CHECK(wrong == 0);
}

TEST_CASE("sRGB encoding rounds the exact curve, to the float, at every threshold") {
  int wrong = 0;
  for (int k = 0; k < 255; ++k) {
    const long double threshold = curve((static_cast<long double>(k) + 0.5L) / 255.0L);
    auto value = static_cast<float>(threshold);
    for (int step = 0; step < 8; ++step) value = std::nextafter(value, 0.0f);
    for (int step = 0; step < 17; ++step) {
      const int expected = static_cast<long double>(value) >= threshold ? k + 1 : k;
      wrong += linear_to_srgb8(value) != expected;
      value = std::nextafter(value, 2.0f);
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("sRGB encoding never falls as the light rises") {
  int wrong = 0;
  int last = 0;
  for (int i = 0; i <= 100'000; ++i) {
    const int now = linear_to_srgb8(static_cast<float>(i) / 100'000.0f);
    wrong += now < last;
    last = now;
  }
  CHECK(wrong == 0);
  CHECK(last == 255);
}

TEST_CASE("sRGB encoding holds what lies outside 0 to 1 at the ends, and NaN at 0") {
  for (const float value : {-0.0f, -1e-20f, -3.0f, -kInfinity, kNan}) {
    CHECK(linear_to_srgb8(value) == 0);
  }
  for (const float value : {1.0f, 1.0001f, 1e30f, kInfinity}) CHECK(linear_to_srgb8(value) == 255);
}

TEST_CASE("the decimal sRGB table is the curve printed with 8 digits and read again") {
  int wrong = 0;
  int beside = 0;
  for (int k = 0; k < 256; ++k) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.7e",
                  static_cast<double>(curve(static_cast<long double>(k) / 255.0L)));
    wrong += srgb8_to_linear_decimal(code(k)) != std::strtof(text.data(), nullptr);
    beside += srgb8_to_linear_decimal(code(k)) != srgb8_to_linear(code(k));
  }
  CHECK(wrong == 0);
  CHECK(beside == 26);
}

TEST_CASE("the sRGB cubic is what llvmpipe was seen to give, fused or not") {
  for (const Contraction contraction : {Contraction::unfused, Contraction::fused}) {
    CHECK(srgb8_to_linear_by_cubic(0, contraction) == 0.0f);
    CHECK(srgb8_to_linear_by_cubic(16, contraction) == 0x1.5ae054p-8f);
    CHECK(srgb8_to_linear_by_cubic(128, contraction) == 0x1.bbacb8p-3f);
    CHECK(srgb8_to_linear_by_cubic(255, contraction) == 1.0f);
  }
}

TEST_CASE("the sRGB cubic lies within 0.0012 of the curve, and rises") {
  double worst = 0.0;
  int falls = 0;
  for (int k = 0; k < 256; ++k) {
    const auto cubic = srgb8_to_linear_by_cubic(code(k), Contraction::unfused);
    worst = std::max(worst, std::fabs(static_cast<double>(cubic) - srgb8_to_linear(code(k))));
    falls += k > 0 && cubic <= srgb8_to_linear_by_cubic(code(k - 1), Contraction::unfused);
  }
  CHECK(worst < 0.0012);
  CHECK(worst > 0.0011);
  CHECK(falls == 0);
}

TEST_CASE("by the reciprocal 126 of the 8-bit codes decode to the float beside k / 255") {
  int beside = 0;
  int wrong = 0;
  for (int k = 0; k < 256; ++k) {
    const float value = unorm8_by_reciprocal(code(k));
    beside += value != unorm8_to_linear(code(k));
    wrong += std::fabs(static_cast<double>(value) - k / 255.0) > value * 0x1p-23;
  }
  CHECK(beside == 126);
  CHECK(wrong == 0);
  CHECK(unorm8_by_reciprocal(255) == 1.0f);
}

TEST_CASE("8 bits rounded to even are those of the rounded product, at every threshold") {
  int wrong = 0;
  int ties = 0;
  for (int k = 0; k < 255; ++k) {
    auto value = static_cast<float>((k + 0.5) / 255.0);
    for (int step = 0; step < 8; ++step) value = std::nextafter(value, 0.0f);
    for (int step = 0; step < 17; ++step) {
      const float product = value * 255.0f;
      const double rest = static_cast<double>(product) - k;
      const bool tie = rest == 0.5;
      ties += tie;
      const int expected = rest > 0.5 || (tie && k % 2 == 1) ? k + 1 : k;
      wrong += linear_to_unorm8(value, UnormRounding::nearest_even) != expected;
      value = std::nextafter(value, 2.0f);
    }
  }
  CHECK(wrong == 0);
  CHECK(ties > 255);
}

TEST_CASE("8 bits rounded to even hold what lies outside 0 to 1 at the ends, and NaN at 0") {
  for (const float value : {-0.0f, -1e-20f, -3.0f, -kInfinity, kNan}) {
    CHECK(linear_to_unorm8(value, UnormRounding::nearest_even) == 0);
  }
  for (const float value : {1.0f, 1.0001f, 1e30f, kInfinity}) {
    CHECK(linear_to_unorm8(value, UnormRounding::nearest_even) == 255);
  }
}

TEST_CASE("every linear 8-bit code survives decoding and encoding") {
  int wrong = 0;
  for (int k = 0; k < 256; ++k) wrong += linear_to_unorm8(unorm8_to_linear(code(k))) != k;
  CHECK(wrong == 0);
}

TEST_CASE("linear 8 bits decode to k / 255, correctly rounded") {
  int wrong = 0;
  for (int k = 0; k < 256; ++k) {
    wrong += unorm8_to_linear(code(k)) != static_cast<float>(static_cast<long double>(k) / 255.0L);
  }
  CHECK(wrong == 0);
}

TEST_CASE("linear 8 bits round 255 times the value to nearest") {
  int wrong = 0;
  for (int k = 0; k < 255; ++k) {
    const double threshold = (k + 0.5) / 255.0;
    auto value = static_cast<float>(threshold);
    for (int step = 0; step < 8; ++step) value = std::nextafter(value, 0.0f);
    for (int step = 0; step < 17; ++step) {
      const double exact = static_cast<double>(value) * 255.0;
      wrong += linear_to_unorm8(value) != (exact >= k + 0.5 ? k + 1 : k);
      value = std::nextafter(value, 2.0f);
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("linear 8 bits hold what lies outside 0 to 1 at the ends, and NaN at 0") {
  for (const float value : {-0.0f, -1e-20f, -3.0f, -kInfinity, kNan}) {
    CHECK(linear_to_unorm8(value) == 0);
  }
  for (const float value : {1.0f, 1.0001f, 1e30f, kInfinity}) CHECK(linear_to_unorm8(value) == 255);
}

#include "raster/numbers/half.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "tests/support/raster_helpers.h"

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>
#define SOFTFOCUS_TEST_F16C 1
#endif

using namespace softfocus;

namespace {

constexpr HalfRounding kNearest = HalfRounding::nearest_even;
constexpr HalfRounding kTruncate = HalfRounding::toward_zero;
constexpr HalfRounding kSwiftshader = HalfRounding::swiftshader;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

bool is_nan_half(int half) { return (half & 0x7FFF) > 0x7C00; }

// The format's definition, field by field, in binary64.
double value_by_fields(int half) {
  const double sign = (half & 0x8000) != 0 ? -1.0 : 1.0;
  const int exponent = half >> 10 & 31;
  const int mantissa = half & 1023;
  if (exponent == 31) return sign * std::numeric_limits<double>::infinity();
  if (exponent == 0) return sign * std::ldexp(mantissa, -24);
  return sign * std::ldexp(1024 + mantissa, exponent - 25);
}

// Encoding by division: how many steps of the half's own size go into the value.
std::uint16_t encode_by_division(float value, HalfRounding rounding) {
  const int sign = std::signbit(value) ? 0x8000 : 0;
  const double magnitude = std::fabs(static_cast<double>(value));
  if (std::isnan(value)) return 0x7E00;
  if (std::isinf(value)) return static_cast<std::uint16_t>(sign | 0x7C00);
  const int exponent = magnitude < 0x1p-14 ? -14 : std::ilogb(magnitude);
  const double steps = std::ldexp(magnitude, 10 - exponent);
  double whole = std::floor(steps);
  const double rest = steps - whole;
  if (rounding == kNearest && (rest > 0.5 || (rest == 0.5 && std::fmod(whole, 2.0) == 1.0))) {
    whole += 1.0;
  }
  if (std::ldexp(whole, exponent - 10) > 65504.0) {
    return static_cast<std::uint16_t>(sign | (rounding == kNearest ? 0x7C00 : 0x7BFF));
  }
  return static_cast<std::uint16_t>(sign | (static_cast<int>(whole) + (exponent + 14) * 1024));
}

// SwiftShader's: below 2^-14 in steps of 2^-37 first.
std::uint16_t encode_as_swiftshader(float value) {
  const int sign = std::signbit(value) ? 0x8000 : 0;
  const double magnitude = std::fabs(static_cast<double>(value));
  if (!std::isfinite(value)) return kHalfNan;
  const int exponent = magnitude < 0x1p-14 ? -14 : std::ilogb(magnitude);
  double steps = std::ldexp(magnitude, 10 - exponent);
  if (exponent == -14) steps = std::floor(steps * 8192.0) / 8192.0;
  double whole = std::floor(steps);
  const double rest = steps - whole;
  if (rest > 0.5 || (rest == 0.5 && std::fmod(whole, 2.0) == 1.0)) whole += 1.0;
  const int half = static_cast<int>(whole) + (exponent + 14) * 1024;
  return static_cast<std::uint16_t>(half > kHalfInfinity ? kHalfNan : sign | half);
}

// Wrong halves among the floats from `first` on, as bits, every `step`, of either sign.
int count_unlike_swiftshader(std::uint32_t first, std::uint32_t end, std::uint32_t step) {
  int wrong = 0;
  for (std::uint32_t bits = first; bits < end; bits += step) {
    for (const std::uint32_t sign : {0u, 0x80000000u}) {
      const auto value = std::bit_cast<float>(sign | bits);
      wrong += float_to_half(value, kSwiftshader) != encode_as_swiftshader(value);
    }
  }
  return wrong;
}

// Calls visit(lower, upper, middle) for all neighbouring finite halves of one sign.
template <class Visit>
void for_each_gap(Visit visit) {
  for (const int sign : {0, 0x8000}) {
    for (int half = 0; half < kHalfLargest; ++half) {
      const double middle = (value_by_fields(half) + value_by_fields(half + 1)) * 0.5;
      const auto lower = static_cast<std::uint16_t>(sign | half);
      const auto upper = static_cast<std::uint16_t>(sign | (half + 1));
      visit(lower, upper, static_cast<float>(sign != 0 ? -middle : middle));
    }
  }
}

}  // namespace

static_assert(half_to_float(kHalfOne) == 1.0f &&
                  float_to_half(1.0f, HalfRounding::toward_zero) == kHalfOne,
              "both directions work at compile time");

TEST_CASE("each of the 65,536 halves decodes to the value of its bit fields") {
  int wrong = 0;
  for (int half = 0; half < 65536; ++half) {
    const float decoded = half_to_float(static_cast<std::uint16_t>(half));
    if (is_nan_half(half)) continue;
    wrong += static_cast<double>(decoded) != value_by_fields(half) ||
             std::signbit(decoded) != ((half & 0x8000) != 0);
  }
  CHECK(wrong == 0);
}

TEST_CASE("a NaN half decodes to a quiet NaN of the same sign and payload") {
  int wrong = 0;
  for (int half = 0; half < 65536; ++half) {
    if (!is_nan_half(half)) continue;
    const auto bits = std::bit_cast<std::uint32_t>(half_to_float(static_cast<std::uint16_t>(half)));
    const std::uint32_t sign = (half & 0x8000) != 0 ? 0x80000000u : 0u;
    wrong += bits != (sign | 0x7FC00000u | static_cast<std::uint32_t>(half & 0x3FF) << 13);
  }
  CHECK(wrong == 0);
}

TEST_CASE("every half that is not NaN survives decoding and encoding") {
  int wrong = 0;
  for (int half = 0; half < 65536; ++half) {
    if (is_nan_half(half)) continue;
    const float decoded = half_to_float(static_cast<std::uint16_t>(half));
    wrong += float_to_half(decoded, kNearest) != half;
    wrong += float_to_half(decoded, kTruncate) != half;
    const bool kept = (half & 0x7FFF) <= largest_kept_half(kSwiftshader);
    wrong += float_to_half(decoded, kSwiftshader) != (kept ? half : kHalfNan);
  }
  CHECK(wrong == 0);
}

TEST_CASE("a float midway between two halves is stored as the even one") {
  int wrong = 0;
  for_each_gap([&](std::uint16_t lower, std::uint16_t upper, float middle) {
    wrong += float_to_half(middle, kNearest) != ((lower & 1) == 0 ? lower : upper);
  });
  CHECK(wrong == 0);
}

TEST_CASE("the floats beside a midpoint are stored as the nearer half") {
  int wrong = 0;
  for_each_gap([&](std::uint16_t lower, std::uint16_t upper, float middle) {
    const float away = std::copysign(kInfinity, middle);
    wrong += float_to_half(std::nextafter(middle, 0.0f), kNearest) != lower;
    wrong += float_to_half(std::nextafter(middle, away), kNearest) != upper;
  });
  CHECK(wrong == 0);
}

TEST_CASE("truncation stores every float between two halves as the one nearer zero") {
  int wrong = 0;
  for_each_gap([&](std::uint16_t lower, std::uint16_t upper, float middle) {
    const float away = std::copysign(kInfinity, middle);
    const float end = half_to_float(upper);
    for (const float inside :
         {std::nextafter(half_to_float(lower), away), std::nextafter(middle, 0.0f), middle,
          std::nextafter(middle, away), std::nextafter(end, 0.0f)}) {
      wrong += float_to_half(inside, kTruncate) != lower;
    }
    wrong += float_to_half(end, kTruncate) != upper;
  });
  CHECK(wrong == 0);
}

TEST_CASE("rounding to nearest turns 65520 and all above into infinity, of either sign") {
  for (const float value : {65520.0f, 65536.0f, 131072.0f, 3e38f}) {
    CHECK(float_to_half(value, kNearest) == 0x7C00);
    CHECK(float_to_half(-value, kNearest) == 0xFC00);
  }
}

TEST_CASE("rounding to nearest keeps what lies below 65520 at 65504") {
  CHECK(float_to_half(65504.0f, kNearest) == 0x7BFF);
  CHECK(float_to_half(std::nextafter(65520.0f, 0.0f), kNearest) == 0x7BFF);
  CHECK(float_to_half(-std::nextafter(65520.0f, 0.0f), kNearest) == 0xFBFF);
}

TEST_CASE("truncation keeps every finite float at 65504 or below") {
  for (const float value : {65504.0f, 65520.0f, 65536.0f, std::numeric_limits<float>::max()}) {
    CHECK(float_to_half(value, kTruncate) == 0x7BFF);
    CHECK(float_to_half(-value, kTruncate) == 0xFBFF);
  }
}

TEST_CASE("infinity stays infinity in both roundings") {
  for (const HalfRounding rounding : {kNearest, kTruncate}) {
    CHECK(float_to_half(kInfinity, rounding) == 0x7C00);
    CHECK(float_to_half(-kInfinity, rounding) == 0xFC00);
  }
}

TEST_CASE("SwiftShader's subnormals lose what lies below 2^-37 before they are rounded") {
  CHECK(float_to_half(0x1.8p-24f, kSwiftshader) == 2);       // the middle of 1 and 2
  CHECK(float_to_half(0x1.4p-23f, kSwiftshader) == 2);       // of 2 and 3
  CHECK(float_to_half(0x1.4004p-23f, kSwiftshader) == 3);    // 2^-37 above it
  CHECK(float_to_half(0x1.4003FEp-23f, kSwiftshader) == 2);  // a float less: the middle
  CHECK(float_to_half(0x1.4003FEp-23f, kNearest) == 3);
  CHECK(float_to_half(std::nextafter(0x1p-25f, 1.0f), kSwiftshader) == 0);
  CHECK(float_to_half(-0x1.002p-25f, kSwiftshader) == 0x8001);
  // Normal halves lose nothing.
  CHECK(float_to_half(std::nextafter(0x1.002p-14f, 1.0f), kSwiftshader) == 0x0401);
}

TEST_CASE("SwiftShader stores infinity from 65520 to 65568, and NaN beyond, infinity too") {
  CHECK(float_to_half(std::nextafter(65520.0f, 0.0f), kSwiftshader) == 0x7BFF);
  for (const float value : {65520.0f, 65536.0f, 65568.0f}) {
    CHECK(float_to_half(value, kSwiftshader) == 0x7C00);
    CHECK(float_to_half(-value, kSwiftshader) == 0xFC00);
  }
  for (const float value : {std::nextafter(65568.0f, 1e6f), 1e6f, 3e38f, kInfinity}) {
    CHECK(float_to_half(value, kSwiftshader) == 0x7E00);
    CHECK(float_to_half(-value, kSwiftshader) == 0x7E00);
  }
}

TEST_CASE("floats all over become the halves of SwiftShader's definition") {
  CHECK(count_unlike_swiftshader(0, 0x7FFFFFFF, 251) == 0);
  // Around every multiple of 2^10 floats: a half's middles, and its neighbours, are among them.
  int wrong = 0;
  for (std::uint32_t bits = 0x33000000; bits < 0x47900000; bits += 1024) {
    wrong += count_unlike_swiftshader(bits - 2, bits + 3, 1);
  }
  CHECK(wrong == 0);
}

TEST_CASE("so do all that become subnormal halves" * doctest::test_suite("long")) {
  CHECK(count_unlike_swiftshader(0x32800000, 0x38800000, 1) == 0);
}

TEST_CASE("any NaN is stored as one, its sign and payload forgotten") {
  for (const std::uint32_t payload : {1u, 0x1FFFu, 0x2000u, 0x400000u, 0x7FFFFFu}) {
    for (const HalfRounding rounding : {kNearest, kTruncate, kSwiftshader}) {
      CHECK(float_to_half(std::bit_cast<float>(0x7F800000u | payload), rounding) == 0x7E00);
      CHECK(float_to_half(std::bit_cast<float>(0xFF800000u | payload), rounding) == 0x7E00);
    }
  }
}

TEST_CASE("half of the smallest subnormal is stored as zero, the float above it as the smallest") {
  CHECK(float_to_half(0x1p-25f, kNearest) == 0x0000);
  CHECK(float_to_half(-0x1p-25f, kNearest) == 0x8000);
  CHECK(float_to_half(std::nextafter(0x1p-25f, 1.0f), kNearest) == 0x0001);
  CHECK(float_to_half(std::nextafter(0x1p-24f, 0.0f), kTruncate) == 0x0000);
}

TEST_CASE("the largest subnormal rounds up to the smallest normal half") {
  CHECK(float_to_half(0x1p-14f, kTruncate) == 0x0400);
  CHECK(float_to_half(std::nextafter(0x1p-14f, 0.0f), kNearest) == 0x0400);
  CHECK(float_to_half(std::nextafter(0x1p-14f, 0.0f), kTruncate) == 0x03FF);
}

TEST_CASE("zeros and float subnormals are stored as the zero of their sign") {
  for (const float value : {0.0f, std::numeric_limits<float>::denorm_min(), 0x1p-126f, 0x1p-26f}) {
    for (const HalfRounding rounding : {kNearest, kTruncate, kSwiftshader}) {
      CHECK(float_to_half(value, rounding) == 0x0000);
      CHECK(float_to_half(-value, rounding) == 0x8000);
    }
  }
}

TEST_CASE("encoding random floats agrees with encoding by division") {
  test::Random random{2026};
  int wrong = 0;
  for (int i = 0; i < 400'000; ++i) {
    auto bits = static_cast<std::uint32_t>(random.next());
    // Every second one where halves live: exponents -30 to 17.
    if (i % 2 == 0) {
      const auto exponent = static_cast<std::uint32_t>(random.whole(97, 144));
      bits = (bits & 0x807FFFFFu) | exponent << 23;
    }
    const auto value = std::bit_cast<float>(bits);
    for (const HalfRounding rounding : {kNearest, kTruncate}) {
      wrong += float_to_half(value, rounding) != encode_by_division(value, rounding);
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("equal halves and the two zeros lie 0 apart") {
  int wrong = 0;
  for (int half = 0; half < 65536; ++half) {
    const auto h = static_cast<std::uint16_t>(half);
    wrong += half_ulps_between(h, h) != 0;
  }
  CHECK(wrong == 0);
  CHECK(half_ulps_between(0x0000, 0x8000) == 0);
}

TEST_CASE("neighbouring halves lie 1 apart, 65504 and infinity too") {
  int wrong = 0;
  for (int half = 0; half < 0x7C00; ++half) {
    for (const int sign : {0, 0x8000}) {
      wrong += half_ulps_between(static_cast<std::uint16_t>(sign | half),
                                 static_cast<std::uint16_t>(sign | (half + 1))) != 1;
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("the distance of halves is symmetric and adds up along the number line") {
  test::Random random{3};
  int wrong = 0;
  for (int i = 0; i < 100'000; ++i) {
    std::array<std::uint16_t, 3> h{};
    for (auto& value : h) {
      do value = static_cast<std::uint16_t>(random.next());
      while (is_nan_half(value));
    }
    std::sort(h.begin(), h.end(),
              [](auto a, auto b) { return value_by_fields(a) < value_by_fields(b); });
    wrong += half_ulps_between(h[0], h[2]) != half_ulps_between(h[2], h[0]);
    wrong += half_ulps_between(h[0], h[1]) + half_ulps_between(h[1], h[2]) !=
             half_ulps_between(h[0], h[2]);
  }
  CHECK(wrong == 0);
}

TEST_CASE("two NaNs lie 0 apart, a NaN and a number as far as can be") {
  CHECK(half_ulps_between(0x7E00, 0xFC01) == 0);
  CHECK(half_ulps_between(0x7E00, 0x3C00) == 65535);
  CHECK(half_ulps_between(0xFC00, 0x7FFF) == 65535);
}

namespace {

struct Differences {
  std::uint64_t numbers = 0;
  std::uint64_t nans = 0;
};

#ifdef SOFTFOCUS_TEST_F16C
__attribute__((target("avx,f16c"))) void add_differences_from_hardware(std::uint32_t first,
                                                                       Differences& found) {
  alignas(32) std::array<float, 8> values;
  for (std::uint32_t i = 0; i < 8; ++i) values[i] = std::bit_cast<float>(first + i);
  const __m256 vector = _mm256_load_ps(values.data());
  alignas(16) std::array<std::uint16_t, 8> nearest;
  alignas(16) std::array<std::uint16_t, 8> truncated;
  _mm_store_si128(reinterpret_cast<__m128i*>(nearest.data()),
                  _mm256_cvtps_ph(vector, _MM_FROUND_TO_NEAREST_INT));
  _mm_store_si128(reinterpret_cast<__m128i*>(truncated.data()),
                  _mm256_cvtps_ph(vector, _MM_FROUND_TO_ZERO));
  for (std::size_t i = 0; i < 8; ++i) {
    for (const auto& [hardware, rounding] :
         {std::pair{nearest[i], kNearest}, std::pair{truncated[i], kTruncate}}) {
      const std::uint16_t ours = float_to_half(values[i], rounding);
      if (std::isnan(values[i])) {
        found.nans += !is_nan_half(hardware) || ours != 0x7E00;
      } else {
        found.numbers += hardware != ours;
      }
    }
  }
}
#endif

void add_differences_from_division(std::uint32_t first, Differences& found) {
  for (std::uint32_t i = 0; i < 8; ++i) {
    const auto value = std::bit_cast<float>(first + i);
    for (const HalfRounding rounding : {kNearest, kTruncate}) {
      found.numbers += float_to_half(value, rounding) != encode_by_division(value, rounding);
    }
  }
}

}  // namespace

// Long (20 seconds with -O2); run with --no-skip. Hardware keeps a NaN's sign and the upper
// ten bits of its payload where we store 0x7E00, so of NaNs only the kind compares.
TEST_CASE("all 2^32 floats are stored as the conversion instruction stores them" *
          doctest::skip()) {
  auto add_differences = add_differences_from_division;
#ifdef SOFTFOCUS_TEST_F16C
  // Every CPU with AVX2 has F16C, whose own name clang 14 does not know here.
  if (__builtin_cpu_supports("avx2")) {
    add_differences = add_differences_from_hardware;
  } else
#endif
  {
    MESSAGE("no F16C here: compared with encoding by division instead");
  }
  Differences found;
  std::uint32_t first = 0;
  do {
    add_differences(first, found);
    first += 8;
  } while (first != 0);
  CHECK(found.numbers == 0);
  CHECK(found.nans == 0);
}

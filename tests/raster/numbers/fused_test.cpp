#include "raster/numbers/fused.h"

#include <doctest/doctest.h>

#include "tests/support/raster_helpers.h"

using namespace softfocus;

namespace {

bool agrees(float a, float b, float c) {
  const float expected = std::fma(a, b, c);
  const float ours = fused_by_rounding_to_odd(a, b, c);
  return std::bit_cast<std::uint32_t>(ours) == std::bit_cast<std::uint32_t>(expected) ||
         (std::isnan(ours) && std::isnan(expected));
}

}  // namespace

TEST_CASE("a fused multiply-add by rounding to odd equals the C library's, for any floats") {
  test::Random random{51};
  const auto any_float = [&] {
    return std::bit_cast<float>(static_cast<std::uint32_t>(random.next() >> 32));
  };
  int wrong = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    const float a = any_float();
    const float b = any_float();
    const float product = a * b;
    wrong += !agrees(a, b, any_float());
    wrong += !agrees(a, b, -product);
    wrong += !agrees(a, b, std::ldexp(product, random.whole(-60, 60)));
  }
  CHECK(wrong == 0);
}

TEST_CASE("a fused multiply-add by rounding to odd decides a tie by what lies far below it") {
  // (1 + 2^-12)^2 = 1 + 2^-11 + 2^-24: half-way between two floats.
  constexpr float kRoot = 1.0f + 0x1p-12f;
  constexpr float kBelow = 1.0f + 0x1p-11f;
  CHECK(fused_by_rounding_to_odd(kRoot, kRoot, 0.0f) == kBelow);
  CHECK(fused_by_rounding_to_odd(kRoot, kRoot, -0x1p-120f) == kBelow);
  CHECK(fused_by_rounding_to_odd(kRoot, kRoot, 0x1p-120f) == kBelow + 0x1p-23f);
}

TEST_CASE("a fused multiply-add by rounding to odd has subnormal results rounded once") {
  test::Random random{52};
  int wrong = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    const float a = random.between(1.0f, 2.0f) * 0x1p-70f;
    const float b = random.between(1.0f, 2.0f) * 0x1p-70f;
    wrong += !agrees(a, b, std::ldexp(random.between(-2.0f, 2.0f), random.whole(-149, -120)));
  }
  CHECK(wrong == 0);
}

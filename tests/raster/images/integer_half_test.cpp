// Halves filtered in integers: what D3D11.3 7.18.16.3 asks of a filter, and each rounding
// against 128-bit integers.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "raster/images/integer_bilinear.h"
#include "raster/images/integer_filter.h"
#include "raster/numbers/half.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

using Corners = std::array<std::uint16_t, 4>;  // c00, c10, c01, c11

std::uint16_t any_half(Random& random) {
  constexpr std::array<std::uint16_t, 10> kExtreme{0x0000, 0x8000, 0x0001, 0x8001, 0x03FF,
                                                   0x8400, 0x3C00, 0xBBFF, 0x7BFF, 0xFBFF};
  const std::uint64_t bits = random.next();
  if (bits % 3 == 0) return kExtreme[(bits >> 8) % kExtreme.size()];
  const auto half = static_cast<std::uint16_t>(bits >> 16);
  return is_finite_half(half) ? half : static_cast<std::uint16_t>(half & 0xBFFFu);
}

// Each half by itself, or of one magnitude, or of one magnitude and sign.
Corners any_corners(Random& random) {
  const std::uint64_t kind = random.next() % 3;
  const std::uint16_t like = any_half(random);
  Corners corners{};
  for (std::uint16_t& half : corners) {
    half = any_half(random);
    if (kind == 1) half = static_cast<std::uint16_t>((half & 0x80FFu) | (like & 0x7F00u));
    if (kind == 2) half = static_cast<std::uint16_t>((half & 0x000Fu) | (like & 0xFFF0u));
  }
  return corners;
}

int any_weight(Random& random) { return static_cast<int>(random.next() % 256); }

std::int64_t sum_of(const Corners& c, int u, int v) {
  return bilinear_sum_half(c[0], c[1], c[2], c[3], u, v);
}

float mixed(const Corners& fine, const Corners& coarse, int u, int v, int weight) {
  return std::bit_cast<float>(mix_sums_half(sum_of(fine, u, v), sum_of(coarse, u, v), weight));
}

float filtered(const Corners& c, int u, int v) { return mixed(c, c, u, v, 0); }

}  // namespace

TEST_CASE("halves in integers: every finite one is its value times 2^24") {
  for (std::uint32_t bits = 0; bits < 0x10000; ++bits) {
    const auto half = static_cast<std::uint16_t>(bits);
    REQUIRE(is_finite_half(half) == std::isfinite(half_to_float(half)));
    if (!is_finite_half(half)) continue;
    REQUIRE(static_cast<double>(half_to_integer(half)) ==
            static_cast<double>(half_to_float(half)) * 0x1p24);
  }
}

#ifdef __SIZEOF_INT128__
namespace {

__extension__ typedef __int128 Wide;

// In 2^-48, which all that is mixed here is a multiple of.
Wide in_48(float value) { return static_cast<Wide>(static_cast<double>(value) * 0x1p48); }

Wide exact_mean(const Corners& c, int u, int v) {  // in 2^-40
  const auto in_24 = [&](std::size_t i) { return in_48(half_to_float(c[i])) >> 24; };
  return in_24(0) * ((256 - u) * (256 - v)) + in_24(1) * (u * (256 - v)) +
         in_24(2) * ((256 - u) * v) + in_24(3) * (u * v);
}

// Whether no binary32 is nearer to `exact` in 2^-48, and a tie's mantissa is even.
bool is_nearest(float value, Wide exact) {
  const auto distance = [&](float other) {
    const Wide difference = in_48(other) - exact;
    return difference < 0 ? -difference : difference;
  };
  const Wide here = distance(value);
  if (here == 0) return true;
  const Wide beside = std::min(distance(std::nextafter(value, -INFINITY)),
                               distance(std::nextafter(value, INFINITY)));
  return here < beside || (here == beside && std::bit_cast<std::uint32_t>(value) % 2 == 0);
}

}  // namespace

TEST_CASE("halves in integers: one level and two are rounded once, to the nearest binary32") {
  Random random{31};
  int ties = 0;
  for (int i = 0; i < 300000; ++i) {
    const Corners fine = any_corners(random), coarse = any_corners(random);
    const int u = any_weight(random), v = any_weight(random);
    const int weight = static_cast<int>(random.next() % 257);
    const Wide first = exact_mean(fine, u, v), second = exact_mean(coarse, u, v);
    REQUIRE(Wide{sum_of(fine, u, v)} == first);
    const Wide exact = first * (256 - weight) + second * weight;
    const float value = mixed(fine, coarse, u, v, weight);
    REQUIRE(is_nearest(value, exact));
    REQUIRE(is_nearest(filtered(fine, u, v), first * 256));
    const bool sign = std::signbit(value);
    REQUIRE(sign == (exact < 0));
    ties +=
        in_48(value) != exact && in_48(std::nextafter(value, INFINITY)) + in_48(value) == 2 * exact;
  }
  CHECK(ties > 0);
}
#endif

TEST_CASE("halves in integers: ties go to the even mantissa, carries into the exponent") {
  const auto rounded = [](std::uint64_t magnitude) {
    return static_cast<double>(std::bit_cast<float>(round_to_binary32(false, magnitude))) * 0x1p48;
  };
  CHECK(rounded(1) == 1.0);
  CHECK(rounded(0x1000001) == 0x1000000);
  CHECK(rounded(0x1000003) == 0x1000004);
  CHECK(rounded(0x1FFFFFF) == 0x2000000);
  CHECK(rounded(0x20000020000001) == 0x20000040000000);
  CHECK(round_to_binary32(true, 1) == 0xA7800000u);
  CHECK(round_to_binary32(true, 0) == 0u);
  CHECK(std::bit_cast<float>(round_to_binary32(false, std::uint64_t{2047} << 53)) == 65504.0f);
}

TEST_CASE("halves in integers: equal texels give their value at every weight") {
  Random random{32};
  for (int i = 0; i < 20000; ++i) {
    const std::uint16_t half = any_half(random);
    const Corners c{half, half, half, half};
    const int u = any_weight(random), v = any_weight(random);
    const int weight = static_cast<int>(random.next() % 257);
    REQUIRE(filtered(c, u, v) == half_to_float(half));
    REQUIRE(mixed(c, c, u, v, weight) == half_to_float(half));
  }
}

TEST_CASE("halves in integers: weight 0 gives the texel itself, and 256 the next level's") {
  Random random{33};
  for (int i = 0; i < 20000; ++i) {
    const Corners fine = any_corners(random), coarse = any_corners(random);
    REQUIRE(filtered(fine, 0, 0) == half_to_float(fine[0]));
    REQUIRE(mixed(fine, coarse, 0, 0, 0) == half_to_float(fine[0]));
    REQUIRE(mixed(fine, coarse, 0, 0, 256) == half_to_float(coarse[0]));
  }
}

TEST_CASE("halves in integers: a result lies between the least and the greatest texel") {
  Random random{34};
  for (int i = 0; i < 100000; ++i) {
    const Corners fine = any_corners(random), coarse = any_corners(random);
    std::vector<float> texels;
    for (const std::uint16_t half : fine) texels.push_back(half_to_float(half));
    const int u = any_weight(random), v = any_weight(random);
    const auto within = [&](float value) {
      const auto [least, greatest] = std::minmax_element(texels.begin(), texels.end());
      return value >= *least && value <= *greatest;
    };
    REQUIRE(within(filtered(fine, u, v)));
    for (const std::uint16_t half : coarse) texels.push_back(half_to_float(half));
    REQUIRE(within(mixed(fine, coarse, u, v, static_cast<int>(random.next() % 257))));
  }
}

TEST_CASE("halves in integers: a result never moves against a weight") {
  Random random{35};
  for (int i = 0; i < 2000; ++i) {
    const Corners fine = any_corners(random), coarse = any_corners(random);
    const int u = any_weight(random), v = any_weight(random);
    const auto check = [](float first, float last, int steps, const auto& at) {
      float before = first;
      for (int weight = 1; weight <= steps; ++weight) {
        const float now = at(weight);
        REQUIRE((last >= first ? now >= before : now <= before));
        before = now;
      }
    };
    // On a straight line the last but one tells the direction as well as the end, which no
    // weight of 8 bits reaches.
    check(filtered(fine, 0, v), filtered(fine, 255, v), 255,
          [&](int weight) { return filtered(fine, weight, v); });
    check(filtered(fine, u, 0), filtered(fine, u, 255), 255,
          [&](int weight) { return filtered(fine, u, weight); });
    check(filtered(fine, u, v), filtered(coarse, u, v), 256,
          [&](int weight) { return mixed(fine, coarse, u, v, weight); });
  }
}

TEST_CASE("halves in integers: a fetch at a texel's centre is the texel, outside the edge's") {
  constexpr int kWidth = 5, kHeight = 3, kStride = 24;
  std::vector<std::uint16_t> texels(kStride * kHeight);
  Random random{36};
  for (std::uint16_t& half : texels) half = any_half(random);
  for (int y = -9; y < 12; ++y) {
    for (int x = -9; x < 14; ++x) {
      std::array<std::uint32_t, 4> result{};
      fetch_half(texels.data(), kStride, kWidth, kHeight, 4, 256 * x + 128, 256 * y + 128,
                 result.data());
      const std::uint16_t* texel = texels.data() + std::clamp(y, 0, kHeight - 1) * kStride +
                                   4 * std::clamp(x, 0, kWidth - 1);
      for (std::size_t i = 0; i < 4; ++i) {
        CHECK(std::bit_cast<float>(result[i]) == half_to_float(texel[i]));
      }
    }
  }
  std::uint32_t between = 0;
  const std::array<std::uint16_t, 2> two{0x3C00, 0x4000};  // 1 and 2
  fetch_half(two.data(), 2, 2, 1, 1, 256, 128, &between);
  CHECK(std::bit_cast<float>(between) == 1.5f);
}

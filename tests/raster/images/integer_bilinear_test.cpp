// D3D11.3 7.18.16.3 on filters: both roundings of 8-bit texels in integers.

#include "raster/images/integer_bilinear.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

using Corners = std::array<int, 4>;  // c00, c10, c01, c11

int rounded_once(const Corners& c, int u, int v) {
  return bilinear_unorm8(c[0], c[1], c[2], c[3], u, v);
}
int rounded_by_rows(const Corners& c, int u, int v) {
  return lerp_unorm8(lerp_unorm8(c[0], c[1], u), lerp_unorm8(c[2], c[3], u), v);
}

Corners any_corners(Random& random) {
  Corners corners{};
  for (int& value : corners) {
    value = static_cast<int>(random.next() % 256);
    if (random.next() % 3 == 0) value = value < 128 ? 0 : 255;
  }
  return corners;
}

int any_weight(Random& random) { return static_cast<int>(random.next() % 256); }

}  // namespace

TEST_CASE("bilinear in integers: a result lies between the least and the greatest texel") {
  Random random{11};
  for (int i = 0; i < 200000; ++i) {
    const Corners c = any_corners(random);
    const auto [least, greatest] = std::minmax_element(c.begin(), c.end());
    const int u = any_weight(random), v = any_weight(random);
    for (const int value : {rounded_once(c, u, v), rounded_by_rows(c, u, v)}) {
      if (value < *least || value > *greatest) {
        FAIL("texels ", c[0], " ", c[1], " ", c[2], " ", c[3], " gave ", value);
      }
    }
  }
}

TEST_CASE("bilinear in integers: equal texels give their value at every weight") {
  for (int value = 0; value < 256; ++value) {
    for (int u = 0; u < 256; u += 3) {
      for (int v = 0; v < 256; v += 5) {
        const Corners c{value, value, value, value};
        REQUIRE(rounded_once(c, u, v) == value);
        REQUIRE(rounded_by_rows(c, u, v) == value);
      }
    }
  }
}

TEST_CASE("bilinear in integers: weight 0 gives the texel itself") {
  Random random{12};
  for (int i = 0; i < 1000; ++i) {
    const Corners c = any_corners(random);
    CHECK(rounded_once(c, 0, 0) == c[0]);
    CHECK(rounded_by_rows(c, 0, 0) == c[0]);
  }
}

TEST_CASE("bilinear in integers: rounded once, a result never moves against a weight") {
  Random random{13};
  for (int i = 0; i < 2000; ++i) {
    const Corners c = any_corners(random);
    const int fixed = any_weight(random);
    // Along an axis the mean goes from one end to the other on a straight line.
    const int along_u = (c[1] - c[0]) * (256 - fixed) + (c[3] - c[2]) * fixed;
    const int along_v = (c[2] - c[0]) * (256 - fixed) + (c[3] - c[1]) * fixed;
    for (int weight = 0; weight < 255; ++weight) {
      const int step_u = rounded_once(c, weight + 1, fixed) - rounded_once(c, weight, fixed);
      const int step_v = rounded_once(c, fixed, weight + 1) - rounded_once(c, fixed, weight);
      REQUIRE((along_u >= 0 ? step_u >= 0 : step_u <= 0));
      REQUIRE((along_v >= 0 ? step_v >= 0 : step_v <= 0));
    }
  }
}

TEST_CASE("bilinear in integers: along a line both roundings are monotonic in the weight") {
  for (int a = 0; a < 256; a += 5) {
    for (int b = 0; b < 256; ++b) {
      for (int weight = 0; weight < 255; ++weight) {
        const int step = lerp_unorm8(a, b, weight + 1) - lerp_unorm8(a, b, weight);
        REQUIRE((b >= a ? step >= 0 : step <= 0));
        REQUIRE(lerp_unorm8(a, b, weight) == rounded_once({a, b, a, b}, weight, 7));
      }
    }
  }
}

TEST_CASE("bilinear in integers: a mean is exact to half a level") {
  Random random{14};
  for (int i = 0; i < 100000; ++i) {
    const Corners c = any_corners(random);
    const int u = any_weight(random), v = any_weight(random);
    const double s = u / 256.0, t = v / 256.0;
    const double exact = (c[0] * (1 - s) + c[1] * s) * (1 - t) + (c[2] * (1 - s) + c[3] * s) * t;
    REQUIRE(std::abs(rounded_once(c, u, v) - exact) <= 0.5);
    REQUIRE(std::abs(rounded_by_rows(c, u, v) - exact) <= 1.0);
  }
}

TEST_CASE("bilinear in integers: a fetch at a texel's centre is the texel, outside the edge's") {
  constexpr int kWidth = 5, kHeight = 3, kStride = 24;
  std::vector<std::uint8_t> texels(kStride * kHeight);
  Random random{15};
  for (std::uint8_t& byte : texels) byte = static_cast<std::uint8_t>(random.next());
  for (int y = -9; y < 12; ++y) {
    for (int x = -9; x < 14; ++x) {
      std::array<std::uint8_t, 4> result{};
      fetch_unorm8(texels.data(), kStride, kWidth, kHeight, 4, 256 * x + 128, 256 * y + 128,
                   result.data());
      const std::uint8_t* texel = texels.data() + std::clamp(y, 0, kHeight - 1) * kStride +
                                  4 * std::clamp(x, 0, kWidth - 1);
      CHECK(std::equal(result.begin(), result.end(), texel));
    }
  }
  std::uint8_t between = 0;
  const std::array<std::uint8_t, 2> two{10, 20};
  fetch_unorm8(two.data(), 2, 2, 1, 1, 256, 128, &between);
  CHECK(between == 15);
  for (const std::int32_t far : {INT32_MIN, INT32_MAX}) {
    fetch_unorm8(two.data(), 2, 2, 1, 1, far, far, &between);
    CHECK((between == 10 || between == 20));
  }
}

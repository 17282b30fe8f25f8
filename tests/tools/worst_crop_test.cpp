#include "tools/report/worst_crop.h"

#include <doctest/doctest.h>

#include "tests/support/measure_pictures.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;

namespace {

void check_crop(const Crop& crop, int x, int y, int side) {
  CHECK(crop.x == x);
  CHECK(crop.y == y);
  CHECK(crop.side == side);
}

PixelMap dots(int width, int height, std::initializer_list<std::array<int, 2>> places) {
  PixelMap map = make_pixel_map(width, height);
  for (const auto& place : places) {
    row(map, place[1])[static_cast<std::size_t>(place[0])] = 0.25;
  }
  return map;
}

}  // namespace

TEST_CASE("worst crop: the square with the most error, the first of equal ones") {
  check_crop(worst_crop(dots(20, 10, {{15, 7}}), 4), 12, 4, 4);
  check_crop(worst_crop(dots(20, 10, {{1, 1}, {15, 7}, {17, 8}}), 4), 14, 5, 4);
  check_crop(worst_crop(dots(20, 10, {}), 4), 0, 0, 4);
  check_crop(worst_crop(dots(20, 10, {{19, 9}}), 1), 19, 9, 1);
  check_crop(worst_crop(dots(6, 6, {{5, 5}}), 6), 0, 0, 6);
}

TEST_CASE("worst crop: the sums agree with adding up every square") {
  test::Random random;
  PixelMap map = make_pixel_map(23, 17);
  for (double& value : map.values) value = static_cast<double>(random.next() % 1000) / 1000.0;
  constexpr int kSide = 5;
  double most = 0.0;
  for (int y = 0; y + kSide <= map.height; ++y) {
    for (int x = 0; x + kSide <= map.width; ++x) {
      most = std::max(most, mean(cropped(map, {x, y, kSide})));
    }
  }
  CHECK(mean(cropped(map, worst_crop(map, kSide))) == doctest::Approx(most).epsilon(1e-12));
}

TEST_CASE("a crop has the picture's bits") {
  const Image picture = grey_picture(9, 7, [](int x, int y) { return x + 10 * y; });
  const Image part = cropped(picture, {3, 2, 4});
  CHECK(equal(part, grey_picture(4, 4, [](int x, int y) { return x + 3 + 10 * (y + 2); })));
}

TEST_CASE("reduced: means of blocks, at the border of what is there, clamped to 0..1") {
  const Image picture = grey_picture(5, 3, [](int x, int y) { return y == 2 ? 9.0 : x * 0.125; });
  const Image small = reduced(picture, 2);
  REQUIRE(small.width == 3);
  REQUIRE(small.height == 2);
  for (int x = 0; x < 3; ++x) {
    const double grey = x == 2 ? 0.5 : 0.0625 + 0.25 * x;
    CHECK(double{load_texel<Format::rgba16f>(small, x, 0).x} == grey);
    CHECK(load_texel<Format::rgba16f>(small, x, 1).y == 1.0f);
  }
}

TEST_CASE("reduced: a map's means, and the same mean where blocks are whole") {
  PixelMap map = make_pixel_map(4, 2);
  for (std::size_t i = 0; i < map.values.size(); ++i) map.values[i] = static_cast<double>(i);
  const PixelMap small = reduced(map, 2);
  CHECK(small.width == 2);
  CHECK(small.height == 1);
  CHECK(small.values == std::vector<double>{2.5, 4.5});
  CHECK(mean(small) == mean(map));
  CHECK(reduced(map, 3).values == std::vector<double>{3.0, 5.0});
}

TEST_CASE("the reduction factor is the least that makes a picture small enough") {
  CHECK(reduction_factor(1024, 1024, 205) == 5);
  CHECK(reduction_factor(1024, 512, 256) == 4);
  CHECK(reduction_factor(512, 1025, 256) == 5);
  CHECK(reduction_factor(64, 64, 256) == 1);
}

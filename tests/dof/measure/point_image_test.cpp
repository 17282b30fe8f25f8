#include "dof/measure/point_image.h"

#include <doctest/doctest.h>

#include <cmath>

#include "raster/numbers/half.h"
#include "tests/support/measure_pictures.h"

using namespace softfocus;
using doctest::Approx;

namespace {

Image disc(double radius, double centre_x = 32.0, double centre_y = 32.0) {
  return grey_picture(
      64, 64, [=](int x, int y) { return 0.5 * disc_coverage(x, y, centre_x, centre_y, radius); });
}

Image rectangle(int width, int height) {
  return grey_picture(64, 64, [=](int x, int y) {
    return std::abs(2 * x - 63) < width && std::abs(2 * y - 63) < height ? 0.5 : 0.0;
  });
}

}  // namespace

TEST_CASE("energy: of a plain picture, its luminance for each pixel") {
  CHECK(energy(plain_grey(10, 20, 0.5f)) == Approx(100.0).epsilon(1e-12));
  CHECK(energy(plain(10, 20, 0.0f, 1.0f, 0.0f)) == Approx(0.7152 * 200.0).epsilon(1e-12));
  CHECK(energy(plain_grey(10, 20, 100.0f)) == Approx(20000.0).epsilon(1e-12));  // not clamped
}

TEST_CASE("energy: NaN and what is negative count as 0, infinity as the largest half") {
  Image image = plain_grey(2, 2, 0.0f);
  row<std::uint16_t>(image, 0)[1] = kHalfNan;
  store_texel(image, 1, 0, {-1.0f, -1.0f, -1.0f, 2.0f}, {});
  CHECK(energy(image) == 0.0);
  row<std::uint16_t>(image, 1)[1] = kHalfInfinity;
  CHECK(energy(image) == Approx(0.7152 * 65504.0).epsilon(1e-12));
}

TEST_CASE("point: a disc is round, has its radius, its place and its area") {
  for (const double radius : {3.0, 8.0, 20.0}) {
    const PointShape shape = point_shape(disc(radius));
    CAPTURE(radius);
    CHECK(shape.eigenvalue_ratio == Approx(1.0).epsilon(1e-9));
    // The moments are of pixels' centres: 1/12 less than the disc's along each axis.
    CHECK(shape.radius_px == Approx(radius).epsilon(0.02));
    CHECK(shape.energy == Approx(0.5 * 3.14159265 * radius * radius).epsilon(0.005));
    CHECK(shape.centre_x_px == Approx(32.0).epsilon(1e-9));
    CHECK(shape.centre_y_px == Approx(32.0).epsilon(1e-9));
  }
  const PointShape moved = point_shape(disc(8.0, 30.25, 35.5));
  CHECK(moved.centre_x_px == Approx(30.25).epsilon(1e-3));
  CHECK(moved.centre_y_px == Approx(35.5).epsilon(1e-3));
}

TEST_CASE("point: a rectangle's eigenvalues are as the squares of its sides") {
  // The centres of n pixels in a row have the variance (n^2 - 1) / 12.
  CHECK(point_shape(rectangle(20, 10)).eigenvalue_ratio == Approx(99.0 / 399.0).epsilon(1e-9));
  CHECK(point_shape(rectangle(10, 20)).eigenvalue_ratio == Approx(99.0 / 399.0).epsilon(1e-9));
  CHECK(point_shape(rectangle(20, 20)).eigenvalue_ratio == Approx(1.0).epsilon(1e-9));
  CHECK(point_shape(rectangle(20, 20)).radius_px ==
        Approx(std::sqrt(4.0 * 399.0 / 12.0)).epsilon(1e-9));
}

TEST_CASE("point: a line is not round, whatever its direction") {
  CHECK(point_shape(rectangle(20, 2)).eigenvalue_ratio < 0.01);
  const Image diagonal =
      grey_picture(64, 64, [](int x, int y) { return x == y && x > 20 && x < 40 ? 1.0 : 0.0; });
  CHECK(point_shape(diagonal).eigenvalue_ratio == Approx(0.0));
}

TEST_CASE("point: a single pixel is round and has no radius, black has nothing") {
  const PointShape pixel =
      point_shape(grey_picture(9, 9, [](int x, int y) { return x == 4 && y == 5 ? 1.0 : 0.0; }));
  CHECK(pixel.eigenvalue_ratio == 1.0);
  CHECK(pixel.radius_px == 0.0);
  CHECK(pixel.centre_x_px == 4.5);
  CHECK(pixel.centre_y_px == 5.5);
  const PointShape nothing = point_shape(plain_grey(9, 9, 0.0f));
  CHECK(nothing.energy == 0.0);
  CHECK(nothing.eigenvalue_ratio == 1.0);
}

TEST_CASE("point: a disc deviates from itself by nothing, whatever its brightness") {
  // Halves hold the coverage of the rim to 1 in 2048.
  CHECK(disc_deviation(disc(8.0), 8.0) < 1e-3);
  CHECK(disc_deviation(disc(12.5), 12.5) < 1e-3);
}

TEST_CASE("point: a disc of half the radius deviates by the square root of 3") {
  // On a quarter of the area it is 4 times as bright as it should be: errors of 3 there, of 1
  // on the other three quarters: sqrt((9 + 3) / 4).
  CHECK(disc_deviation(disc(10.0), 20.0) == Approx(std::sqrt(3.0)).epsilon(0.02));
}

TEST_CASE("point: a square deviates from the disc of its area by what sticks out") {
  // The two areas' difference is 0.1812 of either; rims are shared between pixels.
  const double radius = 40.0 / std::sqrt(3.14159265);
  CHECK(disc_deviation(rectangle(40, 40), radius) == Approx(std::sqrt(0.1812)).epsilon(0.05));
}

TEST_CASE("point: black deviates from every disc by NaN") {
  CHECK(std::isnan(disc_deviation(plain_grey(9, 9, 0.0f), 3.0)));
}

TEST_CASE("point: a disc's coverage adds up to its area") {
  double area = 0.0;
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) area += disc_coverage(x, y, 20.3, 19.6, 15.7);
  }
  CHECK(area == Approx(3.14159265 * 15.7 * 15.7).epsilon(1e-3));
}

#include "dof/measure/flip.h"

#include <doctest/doctest.h>

#include "dof/measure/measures.h"
#include "dof/measure/opponent.h"
#include "tests/support/flip_oracle.h"
#include "tests/support/measure_pictures.h"

using namespace softfocus;
using doctest::Approx;

namespace {

PixelMap flip(const Image& a, const Image& b, double pixels_per_degree = kUsualPixelsPerDegree) {
  ThreadPool pool{1};
  return flip_map(a, b, clamped_tone(), pool, pixels_per_degree);
}

/// FLIP of two plain pictures, which must be the same everywhere: they have no features.
double plain_flip(const Image& a, const Image& b) {
  const PixelMap map = flip(a, b);
  CHECK(largest(map) - smallest(map) < 1e-6);
  return mean(map);
}

flip_oracle::Picture for_oracle(const Image& image) {
  flip_oracle::Picture picture{image.width, image.height, {}};
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const glm::vec4 t = load_texel(image, x, y);
      picture.colours.push_back(
          {static_cast<double>(t.x), static_cast<double>(t.y), static_cast<double>(t.z)});
    }
  }
  return picture;
}

double sum(const FilterTaps& taps) {
  double total = 0.0;
  for (const double weight : taps.weights) total += weight;
  return total;
}

}  // namespace

TEST_CASE("FLIP of a picture with itself is exactly 0 everywhere") {
  const Image a = random_scene_image(33, 70, 1);
  CHECK(largest(flip(a, a)) == 0.0);
}

// The values are those of the equations for constant colours, computed apart in Python.
TEST_CASE("FLIP of black against white is 0.9674") {
  CHECK(plain_flip(plain_grey(24, 24, 0.0f), plain_grey(24, 24, 1.0f)) ==
        Approx(0.9673797615193832).epsilon(1e-6));
}

TEST_CASE("FLIP of green against blue, the largest difference there is, is 1") {
  CHECK(plain_flip(plain(24, 24, 0, 1, 0), plain(24, 24, 0, 0, 1)) == Approx(1.0).epsilon(1e-6));
}

TEST_CASE("FLIP of two greys, of two colours and in the dark is the equations'") {
  CHECK(plain_flip(plain_grey(24, 24, 0.5f), plain_grey(24, 24, 0.25f)) ==
        Approx(0.45184961815036434).epsilon(1e-6));
  CHECK(plain_flip(plain(24, 24, 0.5f, 0.25f, 0.125f), plain(24, 24, 0.5f, 0.25f, 0.25f)) ==
        Approx(0.3549074102333158).epsilon(1e-6));
  CHECK(plain_flip(plain(24, 24, 1, 0, 0), plain(24, 24, 0, 1, 0)) ==
        Approx(0.986662275195759).epsilon(1e-6));
  CHECK(plain_flip(plain_grey(24, 24, 0.0f), plain_grey(24, 24, 0x1p-9f)) ==
        Approx(0.08561643944000483).epsilon(1e-6));
}

TEST_CASE("FLIP of a picture is its map's mean, and what all measures together say") {
  ThreadPool pool{2};
  const Image a = grey_picture(40, 30, [](int x, int y) { return 0.1 * ((x + y) % 7); }),
              b = grey_picture(40, 30, [](int x, int y) { return 0.1 * ((x * y) % 5); });
  CHECK(mean_flip(a, b, pool) == mean(flip(a, b)));
  CHECK(mean_flip(a, b, pool) == measure_pictures(a, b, nullptr, {}, pool).whole.flip);
}

TEST_CASE("FLIP is symmetric and within 0 to 1") {
  const Image a = random_scene_image(40, 30, 1);
  const Image b = random_scene_image(40, 30, 2);
  const PixelMap one = flip(a, b);
  const PixelMap other = flip(b, a);
  for (std::size_t i = 0; i < one.values.size(); ++i) {
    CHECK(one.values[i] == Approx(other.values[i]).epsilon(1e-12));
  }
  CHECK(smallest(one) >= 0.0);
  CHECK(largest(one) <= 1.0);
}

TEST_CASE("FLIP agrees with its two-dimensional oracle, borders and strips included") {
  const Image a = random_scene_image(26, 70, 1);
  // Not as noisy: a picture and something like it.
  Image b = a;
  for (int y = 20; y < 40; ++y) {
    for (int x = 8; x < 15; ++x) store_texel(b, x, y, {0.9f, 0.2f, 0.4f, 2.0f}, {});
  }
  // A line, in which points are found, not edges.
  for (int y = 0; y < 70; ++y) store_texel(b, 20, y, {1.0f, 1.0f, 1.0f, 2.0f}, {});
  const auto of_a = for_oracle(a);
  const auto of_b = for_oracle(b);
  for (const double pixels_per_degree : {20.0, kUsualPixelsPerDegree}) {
    const PixelMap map = flip(a, b, pixels_per_degree);
    for (const int y : {0, 21, 39, 63, 64, 69}) {
      for (const int x : {0, 9, 15, 20, 25}) {
        CAPTURE(x);
        CAPTURE(y);
        const double right = flip_oracle::flip(of_a, of_b, x, y, pixels_per_degree);
        CHECK(row(map, y)[static_cast<std::size_t>(x)] == Approx(right).epsilon(1e-4));
      }
    }
  }
}

TEST_CASE("FLIP: an edge that is lost shows where the colours hardly differ") {
  const Image sharp = grey_picture(60, 30, [](int x, int) { return x < 30 ? 0.2 : 0.4; });
  const Image soft = grey_picture(
      60, 30, [](int x, int) { return 0.2 + 0.2 * std::clamp((x - 20) / 20.0, 0.0, 1.0); });
  const PixelMap map = flip(sharp, soft);
  // Seen from afar, both are half-way between the greys in the middle of the edge.
  const double by_colour_alone = plain_flip(plain_grey(24, 24, 0.29f), plain_grey(24, 24, 0.3f));
  CHECK(row(map, 15)[29] > 2.0 * by_colour_alone);
  CHECK(row(map, 15)[5] == 0.0);
}

TEST_CASE("FLIP: what is farther away blurs more: finer stripes are forgiven") {
  const Image stripes = grey_picture(48, 48, [](int x, int) { return x % 2 == 0 ? 0.2 : 0.6; });
  const Image shifted = grey_picture(48, 48, [](int x, int) { return x % 2 == 1 ? 0.2 : 0.6; });
  CHECK(mean(flip(stripes, shifted, 120.0)) < mean(flip(stripes, shifted, 20.0)));
}

TEST_CASE("FLIP is the same on any number of threads" * doctest::test_suite("threads")) {
  ThreadPool one{1};
  ThreadPool three{3};
  const Image a = random_scene_image(30, 200, 1);
  const Image b = random_scene_image(30, 200, 2);
  CHECK(flip_map(a, b, clamped_tone(), one).values == flip_map(a, b, clamped_tone(), three).values);
}

TEST_CASE("FLIP's filters sum to 1, its detectors to 1 and -1") {
  const FlipFilters filters = flip_filters(kUsualPixelsPerDegree);
  for (const FilterTaps* taps : {&filters.achromatic, &filters.red_green, &filters.blue_yellow_wide,
                                 &filters.blue_yellow_narrow, &filters.smooth}) {
    CHECK(sum(*taps) == Approx(1.0).epsilon(1e-12));
  }
  for (const FilterTaps* taps : {&filters.edge, &filters.point}) {
    double positive = 0.0;
    for (const double weight : taps->weights) positive += std::max(weight, 0.0);
    CHECK(positive == Approx(1.0).epsilon(1e-12));
    CHECK(sum(*taps) == Approx(0.0).epsilon(1e-12));
  }
  CHECK(filters.achromatic.radius() == 10);  // ceil(3 sqrt(0.04 / (2 pi^2)) 67.02)
  CHECK(filters.edge.radius() == 9);         // ceil(3 * 0.041 * 67.02)
  CHECK(filters.margin == 10);
}

TEST_CASE("FLIP's edge detector peaks, and its point detector is 0, at one standard deviation") {
  const FlipFilters filters = flip_filters(3.0 / 0.041);  // a deviation of 3 pixels
  const auto at = [](const FilterTaps& taps, int x) {
    return taps.weights[static_cast<std::size_t>(taps.radius() + x)];
  };
  CHECK(at(filters.edge, -3) > at(filters.edge, -2));
  CHECK(at(filters.edge, -3) > at(filters.edge, -4));
  CHECK(at(filters.edge, 3) == -at(filters.edge, -3));
  CHECK(at(filters.edge, 0) == 0.0);
  CHECK(at(filters.point, 2) < 0.0);
  CHECK(at(filters.point, 3) == Approx(0.0).epsilon(1e-9));
  CHECK(at(filters.point, 4) > 0.0);
}

TEST_CASE("opponent colours of white are 100, 0, 0, and there is a way back") {
  const OpponentColour white = to_opponent({1.0, 1.0, 1.0});
  CHECK(white.y == Approx(100.0).epsilon(1e-12));
  CHECK(white.cx == Approx(0.0));
  CHECK(white.cz == Approx(0.0));
  const LinearColour back = to_linear(to_opponent({0.1, 0.7, 0.3}));
  CHECK(back.red == Approx(0.1).epsilon(1e-12));
  CHECK(back.green == Approx(0.7).epsilon(1e-12));
  CHECK(back.blue == Approx(0.3).epsilon(1e-12));
}

TEST_CASE("L*a*b* of the green primary is the tables', its colour faded by L*") {
  const HuntLab green = to_hunt_lab({0.0, 1.0, 0.0});
  CHECK(green.l == Approx(87.74).epsilon(1e-3));
  CHECK(green.a == Approx(0.8774 * -86.18).epsilon(1e-3));
  CHECK(green.b == Approx(0.8774 * 83.18).epsilon(1e-3));
}

TEST_CASE("HyAB is city-block in lightness and straight in colour") {
  CHECK(hyab({50.0, 3.0, 4.0}, {40.0, 0.0, 0.0}) == 15.0);
}

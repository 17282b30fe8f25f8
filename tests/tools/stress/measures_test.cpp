// The atlas's measures on pictures whose numbers are known.

#include "tools/stress/cases/stress_measures.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "dof/measure/point_image.h"
#include "tests/support/measure_pictures.h"

using namespace softfocus;

TEST_CASE("stress: a disc's edge-spread function is its area, counted point by point") {
  constexpr int kSteps = 1000;
  for (const double x : {-1.5, -1.0, -0.6, 0.0, 0.3, 0.9, 1.0, 2.0}) {
    CAPTURE(x);
    int inside = 0, left = 0;
    for (int j = 0; j < kSteps; ++j) {
      for (int i = 0; i < kSteps; ++i) {
        const double u = (2 * i + 1.0) / kSteps - 1.0, v = (2 * j + 1.0) / kSteps - 1.0;
        if (u * u + v * v > 1.0) continue;
        ++inside;
        left += u < x ? 1 : 0;
      }
    }
    CHECK(disc_left_of(x) == doctest::Approx(static_cast<double>(left) / inside).epsilon(0.002));
  }
}

TEST_CASE("stress: column means look at the rows that are asked for") {
  const Image picture = grey_picture(4, 4, [](int x, int y) { return y < 2 ? 100 : x; });
  CHECK(column_means(picture, {2, 4}) == std::vector<double>{0, 1, 2, 3});
  CHECK(column_means(picture, {1, 3})[2] == 51.0);
}

TEST_CASE("stress: differences of profiles, and NaN among them") {
  const std::vector<double> a{0, 1, 2, 3}, b{0, 1, 4, 103};
  CHECK(largest_difference(a, b, {0, 3}) == 2.0);
  CHECK(rms_difference(a, b, {1, 3}) == doctest::Approx(std::sqrt(2.0)));
  const std::vector<double> spoilt{0, 1, std::nan(""), 3};
  CHECK(std::isnan(largest_difference(a, spoilt, {0, 4})));
  CHECK(largest_difference(a, spoilt, {0, 2}) == 0.0);
}

TEST_CASE("stress: a wave's amplitude is found in each row, with its sign") {
  constexpr double kPi2 = 6.283185307179586;
  const Image picture = grey_picture(
      32, 3, [&](int x, int y) { return 0.5 + 0.2 * (y - 1) * std::cos(kPi2 * (x + 0.5) / 8); });
  const std::vector<double> found = wave_amplitudes(picture, 8, {8, 24});
  CHECK(found[0] == doctest::Approx(-0.2).epsilon(0.002));
  CHECK(std::fabs(found[1]) < 1e-6);
  CHECK(found[2] == doctest::Approx(0.2).epsilon(0.002));
}

TEST_CASE("stress: an even disc is even, and one of two halves is not") {
  const auto disc = [](auto grey_at) {
    return grey_picture(
        41, 41, [&](int x, int y) { return std::hypot(x - 20, y - 20) < 10 ? grey_at(x) : 0.0; });
  };
  CHECK(unevenness(disc([](int) { return 0.5; }), 20.5, 20.5, 8) == 0.0);
  const Image halves = disc([](int x) { return x < 20 ? 0.25 : x > 20 ? 0.75 : 0.5; });
  CHECK(unevenness(halves, 20.5, 20.5, 8) == doctest::Approx(0.48).epsilon(0.05));
  CHECK(unevenness(halves, 20.5, 20.5, 1) == 0.0);  // too few pixels to tell
}

TEST_CASE("stress: a rendered disc has its energy and does not deviate from itself") {
  for (const double radius : {1.0, 3.3, 12.0}) {
    CAPTURE(radius);
    const Image disc = grey_picture(
        48, 48, [&](int x, int y) { return 100.0 * disc_light(x, y, 24.5, 24.5, radius); });
    CHECK(energy(disc) == doctest::Approx(100.0).epsilon(0.01));
    CHECK(disc_deviation(disc, radius) < 0.001);
  }
}

TEST_CASE("stress: false change is 0 for the truth, 1 for a still picture") {
  const std::vector<Image> truth{plain_grey(8, 8, 0.2f), plain_grey(8, 8, 0.3f)};
  const std::vector<Image> offset{plain_grey(8, 8, 0.2f), plain_grey(8, 8, 0.2f)};
  CHECK(false_change(truth, truth) == 0.0);
  CHECK(false_change(truth, offset) == doctest::Approx(1.0));
  const std::vector<Image> spoilt{plain_grey(8, 8, 0.2f),
                                  plain_grey(8, 8, std::numeric_limits<float>::quiet_NaN())};
  CHECK(std::isinf(false_change(truth, spoilt)));
}

TEST_CASE("stress: pixels that are no number are counted, and make FLIP infinite") {
  ThreadPool pool{1};
  const Image right = plain_grey(16, 16, 0.5f);
  const Image wrong = grey_picture(16, 16, [](int x, int y) {
    return x == 3 && y < 2 ? std::numeric_limits<double>::infinity() : 0.5;
  });
  CHECK(spoilt_pixels(right) == 0);
  CHECK(spoilt_pixels(wrong) == 2);
  CHECK(answer_flip(right, right, pool) == 0.0);
  CHECK(std::isinf(answer_flip(right, wrong, pool)));
  CHECK(std::isinf(answer_hdr_flip(right, wrong, pool)));
}

#include "dof/measure/flip.h"

#include <doctest/doctest.h>

#include <cmath>

#include "tests/support/measure_pictures.h"

using namespace softfocus;
using doctest::Approx;

namespace {

// The film curve takes this value to 0.85.
constexpr double kBright = 2.118872323987315;

}  // namespace

TEST_CASE("HDR-FLIP: exposures run from the largest luminance to the median") {
  // One pixel of 16, the rest 1/4: six stops apart.
  const Image a = grey_picture(5, 5, [](int x, int y) { return x == 2 && y == 2 ? 16.0 : 0.25; });
  const ExposureRange range = exposure_range(a);
  CHECK(range.first_stops == Approx(std::log2(kBright / 16.0)).epsilon(1e-9));
  CHECK(range.last_stops == Approx(std::log2(kBright / 0.25)).epsilon(1e-9));
  // 6 stops, which rounding may make a little more.
  CHECK(range.count >= 6);
  CHECK(range.count <= 7);
}

TEST_CASE("HDR-FLIP: the median of an even number is the mean of the middle two") {
  const Image a = grey_picture(4, 1, [](int x, int) { return x < 2 ? 1.0 : 3.0; });
  CHECK(exposure_range(a).last_stops == Approx(std::log2(kBright / 2.0)).epsilon(1e-9));
}

TEST_CASE("HDR-FLIP: a plain picture has two exposures at one place, a black one has one") {
  const ExposureRange range = exposure_range(plain_grey(3, 3, 0.5f));
  CHECK(range.count == 2);
  CHECK(range.first_stops == Approx(range.last_stops).epsilon(1e-12));
  CHECK(exposure_range(plain_grey(3, 3, 0.0f)).count == 1);
}

TEST_CASE("HDR-FLIP: a picture that is mostly black has a bounded number of exposures") {
  const Image a = grey_picture(5, 5, [](int x, int y) { return x + y == 0 ? 65504.0 : 0.0; });
  CHECK(exposure_range(a).count == 30);
  const Image darkest = grey_picture(5, 5, [](int x, int) { return x == 0 ? 0x1p-24 : 0.0; });
  CHECK(exposure_range(darkest).count == 2);
}

TEST_CASE("HDR-FLIP of a picture with itself is exactly 0") {
  ThreadPool pool{1};
  const Image a = random_scene_image(20, 20, 1);
  CHECK(largest(hdr_flip_map(a, a, pool)) == 0.0);
}

TEST_CASE("HDR-FLIP sees what is past white, LDR-FLIP does not") {
  ThreadPool pool{1};
  const Image a = plain_grey(20, 20, 8.0f);
  const Image b = plain_grey(20, 20, 4.0f);
  CHECK(largest(flip_map(a, b, clamped_tone(), pool)) == 0.0);
  CHECK(smallest(hdr_flip_map(a, b, pool)) > 0.1);
}

TEST_CASE("HDR-FLIP of plain pictures is FLIP at the one exposure there is") {
  ThreadPool pool{1};
  const Image a = plain_grey(20, 20, 8.0f);
  const Image b = plain_grey(20, 20, 4.0f);
  const double right = mean(flip_map(a, b, filmic_tone(std::log2(kBright / 8.0)), pool));
  CHECK(mean(hdr_flip_map(a, b, pool)) == Approx(right).epsilon(1e-9));
}

TEST_CASE("HDR-FLIP is the largest of its exposures, pixel by pixel") {
  ThreadPool pool{1};
  const Image a = grey_picture(30, 20, [](int x, int) { return x < 10 ? 8.0 : 0.125; });
  // A difference in the lights, one in the shadows.
  const Image b = grey_picture(
      30, 20, [](int x, int y) { return x < 10 ? 6.0 : (x > 25 && y > 15 ? 0.25 : 0.125); });
  const PixelMap map = hdr_flip_map(a, b, pool);
  const ExposureRange range = exposure_range(a);
  const PixelMap first = flip_map(a, b, filmic_tone(range.first_stops), pool);
  const PixelMap last = flip_map(a, b, filmic_tone(range.last_stops), pool);
  for (std::size_t i = 0; i < map.values.size(); ++i) {
    CHECK(map.values[i] >= first.values[i]);
    CHECK(map.values[i] >= last.values[i] - 1e-9);
  }
  CHECK(row(map, 5)[3] > row(last, 5)[3] + 0.01);
  CHECK(row(map, 19)[29] > row(first, 19)[29] + 0.01);
}

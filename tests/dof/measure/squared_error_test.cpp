#include "dof/measure/difference.h"

#include <doctest/doctest.h>

#include <cmath>

#include "raster/numbers/half.h"
#include "tests/support/measure_pictures.h"

using namespace softfocus;
using doctest::Approx;

namespace {

std::uint16_t half(float value) { return float_to_half(value, HalfRounding::nearest_even); }

}  // namespace

TEST_CASE("tone: clamped light is itself in 0..1, and no value is outside") {
  const ToneTable tone = clamped_tone();
  CHECK(tone.size() == 0x10000);
  CHECK(toned(tone, half(0.25f)) == 0.25);
  CHECK(toned(tone, half(1.0f)) == 1.0);
  CHECK(toned(tone, half(7.0f)) == 1.0);
  CHECK(toned(tone, half(-1.0f)) == 0.0);
  CHECK(toned(tone, kHalfInfinity) == 1.0);
  CHECK(toned(tone, kHalfNan) == 0.0);
}

TEST_CASE("tone: the film curve has the published fit's values, and tells bright from brighter") {
  const ToneTable tone = filmic_tone();
  // 0.6 (2.51 * 0.6 + 0.03) / (0.6 (2.43 * 0.6 + 0.59) + 0.14)
  CHECK(toned(tone, half(1.0f)) == Approx(0.673290473407364).epsilon(1e-12));
  CHECK(toned(tone, half(0.0f)) == 0.0);
  CHECK(toned(tone, half(2.0f)) < toned(tone, half(4.0f)));
  CHECK(toned(tone, kHalfInfinity) == 1.0);
}

TEST_CASE("tone: a stop of exposure doubles the light") {
  CHECK(toned(filmic_tone(1.0), half(0.25f)) == toned(filmic_tone(0.0), half(0.5f)));
  CHECK(toned(filmic_tone(-2.0), half(1.0f)) == toned(filmic_tone(0.0), half(0.25f)));
}

TEST_CASE("tone: the film curve's inverse is its inverse") {
  CHECK(filmic_inverse(0.85) == Approx(2.118872323987315).epsilon(1e-12));
  const ToneTable tone = filmic_tone(std::log2(filmic_inverse(0.5)));
  CHECK(toned(tone, half(1.0f)) == Approx(0.5).epsilon(1e-12));
}

TEST_CASE("tone: the sRGB curve goes through 0, its joint, 18 % grey and 1") {
  const ToneTable tone = srgb_encoded(clamped_tone());
  CHECK(toned(tone, half(0.0f)) == 0.0);
  CHECK(toned(tone, half(0x1p-10f)) == Approx(12.92 / 1024.0).epsilon(1e-12));
  CHECK(toned(tone, half(0.21404f)) == Approx(0.5).epsilon(1e-3));
  CHECK(toned(tone, half(1.0f)) == Approx(1.0).epsilon(1e-12));
}

TEST_CASE("squared error: none between a picture and itself") {
  ThreadPool pool{1};
  const Image a = random_scene_image(31, 17, 1);
  CHECK(mean(squared_error_map(a, a, clamped_tone(), pool)) == 0.0);
  CHECK(std::isinf(psnr_db(0.0)));
}

TEST_CASE("squared error: a constant shift has the PSNR of its square") {
  ThreadPool pool{1};
  const Image a = plain_grey(9, 5, 0.5f);
  const Image b = plain_grey(9, 5, 0.25f);
  const double mse = mean(squared_error_map(a, b, clamped_tone(), pool));
  CHECK(mse == 0.0625);
  CHECK(psnr_db(mse) == Approx(12.041199826559248).epsilon(1e-12));  // -10 log10(1/16)
}

TEST_CASE("squared error: colour counts by thirds, alpha not at all") {
  ThreadPool pool{1};
  const Image a = plain(4, 4, 0.5f, 0.5f, 0.5f);
  Image b = plain(4, 4, 0.5f, 1.0f, 0.5f);
  set_depth(b, [](int, int) { return 0.25f; });
  CHECK(mean(squared_error_map(a, b, clamped_tone(), pool)) == Approx(0.25 / 3.0).epsilon(1e-12));
}

TEST_CASE("squared error: each pixel has its own") {
  ThreadPool pool{1};
  const Image a = plain_grey(6, 4, 0.5f);
  Image b = a;
  store_texel(b, 5, 2, {1.0f, 1.0f, 1.0f, 2.0f}, {});
  const PixelMap map = squared_error_map(a, b, clamped_tone(), pool);
  for (int y = 0; y < 4; ++y) {
    for (std::size_t x = 0; x < 6; ++x) CHECK(row(map, y)[x] == (x == 5 && y == 2 ? 0.25 : 0.0));
  }
}

TEST_CASE("squared error: tone-mapped, highlights differ that are alike when clamped") {
  ThreadPool pool{1};
  const Image a = plain_grey(4, 4, 2.0f);
  const Image b = plain_grey(4, 4, 4.0f);
  CHECK(mean(squared_error_map(a, b, clamped_tone(), pool)) == 0.0);
  CHECK(mean(squared_error_map(a, b, srgb_encoded(filmic_tone()), pool)) > 1e-4);
}

TEST_CASE("squared error: PSNR of linear light is that of the count of differences") {
  ThreadPool pool{2};
  const Image a = random_scene_image(40, 70, 1);
  const Image b = random_scene_image(40, 70, 2);
  CHECK(psnr_db(mean(squared_error_map(a, b, clamped_tone(), pool))) ==
        Approx(compare_images(a, b).psnr_db).epsilon(1e-12));
}

#include "dof/measure/code_difference.h"

#include <doctest/doctest.h>

#include <cmath>

#include "raster/images/texel.h"
#include "raster/numbers/srgb.h"

using namespace softfocus;

namespace {

constexpr int kWidth = 40, kHeight = 32;

Image coded(int width, int height) { return make_image(Format::rgba16f, width, height); }

void set_codes(Image& image, int x, int y, int red, int green, int blue) {
  const auto linear = [](int code) { return srgb8_to_linear(static_cast<std::uint8_t>(code)); };
  store_texel<Format::rgba16f>(image, x, y, {linear(red), linear(green), linear(blue), 1.0f},
                               Profile{});
}

/// Samples of n x n within a disc around (18, 15).
int samples_in_disc(int x, int y, int n) {
  int inside = 0;
  const int unit = 2 * n;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const int dx = x * unit + 2 * i + 1 - 18 * unit, dy = y * unit + 2 * j + 1 - 15 * unit;
      inside += dx * dx + dy * dy < 11 * unit * 11 * unit ? 1 : 0;
    }
  }
  return inside;
}

/// A disc, its edge of n x n samples; perhaps with two patches.
Image disc(int n, bool with_patches) {
  Image image = coded(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const int share = samples_in_disc(x, y, n), all = n * n;
      set_codes(image, x, y, 40 + 180 * share / all, 60 + 100 * share / all,
                200 - 150 * share / all);
      if (!with_patches) continue;
      if (y >= 20 && y < 24 && x >= 30 && x < 35) set_codes(image, x, y, 90, 70, 190);
      if (y >= 5 && y < 7 && x >= 33 && x < 37) set_codes(image, x, y, 250, 250, 20);
    }
  }
  return image;
}

}  // namespace

TEST_CASE("codes: counts are those of pixelmatch 7.1 and of ImageMagick 6.9") {
  const Image hard = disc(1, false), smooth = disc(4, true);
  const CodeDifference usual = compare_codes(hard, smooth);
  CHECK(usual.pixels == 104);
  CHECK(usual.mean_error == doctest::Approx(0.0128881).epsilon(1e-5));
  CHECK(usual.rms_error == doctest::Approx(0.0715929).epsilon(1e-5));
  CHECK(usual.max_error == 210);  // .823529 of 255
  CHECK(usual.max_x == 33);
  CHECK(usual.max_y == 5);
  CHECK(usual.beyond == 28);
  CHECK(usual.anti_aliased == 60 - 28);
  const CodeDifference strict = compare_codes(hard, smooth, 0.05);
  CHECK(strict.beyond == 28);
  CHECK(strict.anti_aliased == 68 - 28);
  const CodeDifference lax = compare_codes(hard, smooth, 0.3);
  CHECK(lax.beyond == 8);
  CHECK(lax.anti_aliased == 0);
}

TEST_CASE("codes: the order of the pictures does not matter, and equal ones do not differ") {
  const Image hard = disc(1, false), smooth = disc(4, true);
  const CodeDifference one = compare_codes(hard, smooth), other = compare_codes(smooth, hard);
  CHECK(one.beyond == other.beyond);
  CHECK(one.anti_aliased == other.anti_aliased);
  CHECK(one.rms_error == other.rms_error);
  const CodeDifference none = compare_codes(hard, hard);
  CHECK(none.pixels == 0);
  CHECK(none.max_x == -1);
  CHECK(std::isinf(none.psnr_db));
  CHECK(none.beyond == 0);
}

TEST_CASE("codes: black against white is the whole threshold, light beyond 1 is white") {
  Image black = coded(3, 3), white = coded(3, 3);
  for (int i = 0; i < 9; ++i) {
    set_codes(black, i % 3, i / 3, 0, 0, 0);
    store_texel<Format::rgba16f>(white, i % 3, i / 3, {7.0f, 1.0f, 65504.0f, 1.0f}, Profile{});
  }
  CHECK(compare_codes(black, white, 0.96).beyond == 9);
  CHECK(compare_codes(black, white, 1.0).beyond == 0);
  const CodeDifference found = compare_codes(black, white);
  CHECK(found.max_error == 255);
  CHECK(found.psnr_db == 0.0);
}

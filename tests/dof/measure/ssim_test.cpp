#include "dof/measure/ssim.h"

#include <doctest/doctest.h>

#include <cmath>

#include "tests/support/measure_pictures.h"

using namespace softfocus;
using doctest::Approx;

namespace {

constexpr double kC1 = 0.0001;
constexpr double kC2 = 0.0009;

double ssim(const Image& a, const Image& b) {
  ThreadPool pool{1};
  return mean(ssim_map(a, b, clamped_tone(), pool));
}

/// The equation at one pixel, with the window of 11x11 weights as one.
double ssim_in_two_dimensions(const Image& a, const Image& b, int at_x, int at_y) {
  double sum = 0.0, ma = 0.0, mb = 0.0, aa = 0.0, bb = 0.0, ab = 0.0;
  for (int j = -5; j <= 5; ++j) {
    for (int i = -5; i <= 5; ++i) {
      const double weight = std::exp(-(i * i + j * j) / (2.0 * 1.5 * 1.5));
      const int x = std::clamp(at_x + i, 0, a.width - 1);
      const int y = std::clamp(at_y + j, 0, a.height - 1);
      const auto luma = [&](const Image& image) {
        const glm::vec4 t = load_texel(image, x, y);
        return 0.2126 * static_cast<double>(t.x) + 0.7152 * static_cast<double>(t.y) +
               0.0722 * static_cast<double>(t.z);
      };
      const double la = luma(a), lb = luma(b);
      sum += weight;
      ma += weight * la;
      mb += weight * lb;
      aa += weight * la * la;
      bb += weight * lb * lb;
      ab += weight * la * lb;
    }
  }
  ma /= sum;
  mb /= sum;
  const double variances = aa / sum - ma * ma + bb / sum - mb * mb;
  const double covariance = ab / sum - ma * mb;
  return (2 * ma * mb + kC1) * (2 * covariance + kC2) /
         ((ma * ma + mb * mb + kC1) * (variances + kC2));
}

}  // namespace

TEST_CASE("SSIM of a picture with itself is exactly 1 everywhere") {
  ThreadPool pool{1};
  const Image a = random_scene_image(37, 80, 1);
  const PixelMap map = ssim_map(a, a, srgb_encoded(clamped_tone()), pool);
  CHECK(smallest(map) == 1.0);
  CHECK(largest(map) == 1.0);
}

TEST_CASE("SSIM of two constants is the luminance term") {
  // (2 a b + C1) / (a^2 + b^2 + C1); nothing varies.
  CHECK(ssim(plain_grey(20, 20, 0.5f), plain_grey(20, 20, 0.25f)) ==
        Approx((0.25 + kC1) / (0.3125 + kC1)).epsilon(1e-9));
  CHECK(ssim(plain_grey(20, 20, 0.0f), plain_grey(20, 20, 1.0f)) ==
        Approx(kC1 / (1.0 + kC1)).epsilon(1e-9));
}

TEST_CASE("SSIM of a picture with its negative is negative") {
  // Stripes of 0 and 1 have no mean difference and a covariance of minus the variance.
  const Image a = grey_picture(40, 40, [](int x, int) { return x % 2; });
  const Image b = grey_picture(40, 40, [](int x, int) { return 1 - x % 2; });
  CHECK(ssim(a, b) < -0.95);
}

TEST_CASE("SSIM is symmetric and at most 1") {
  ThreadPool pool{1};
  const Image a = random_scene_image(33, 21, 1);
  const Image b = random_scene_image(33, 21, 2);
  const PixelMap one = ssim_map(a, b, clamped_tone(), pool);
  const PixelMap other = ssim_map(b, a, clamped_tone(), pool);
  CHECK(largest(one) < 1.0);
  CHECK(mean(one) == Approx(mean(other)).epsilon(1e-12));
}

TEST_CASE("SSIM is the equation in two dimensions, borders and strips included") {
  ThreadPool pool{1};
  const Image a = random_scene_image(23, 71, 1);
  const Image b = random_scene_image(23, 71, 2);
  const PixelMap map = ssim_map(a, b, clamped_tone(), pool);
  for (const int y : {0, 3, 35, 63, 64, 70}) {
    for (const int x : {0, 2, 11, 22}) {
      CAPTURE(x);
      CAPTURE(y);
      CHECK(row(map, y)[static_cast<std::size_t>(x)] ==
            Approx(ssim_in_two_dimensions(a, b, x, y)).epsilon(1e-9));
    }
  }
}

TEST_CASE("SSIM reacts to a blur and not to a whole-pixel difference far away") {
  ThreadPool pool{1};
  const Image a = random_scene_image(60, 20, 1);
  Image b = a;
  store_texel(b, 5, 10, {1.0f, 0.0f, 1.0f, 2.0f}, {});
  const PixelMap map = ssim_map(a, b, clamped_tone(), pool);
  CHECK(row(map, 10)[5] < 1.0);
  CHECK(row(map, 10)[11] == 1.0);  // past the window's 5 pixels
}

TEST_CASE("SSIM is the same on any number of threads" * doctest::test_suite("threads")) {
  ThreadPool one{1};
  ThreadPool three{3};
  const Image a = random_scene_image(40, 200, 1);
  const Image b = random_scene_image(40, 200, 2);
  CHECK(ssim_map(a, b, clamped_tone(), one).values == ssim_map(a, b, clamped_tone(), three).values);
}

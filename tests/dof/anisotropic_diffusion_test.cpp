// The claims of dof/methods/anisotropic_diffusion that other methods do not make.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "dof/methods/anisotropic_diffusion.h"
#include "raster/images/texel.h"
#include "tests/support/method_checks.h"
#include "tests/support/sanitizers.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

void check_oracle(const Image& scene, float max_coc, const PixelCoc& lens = {40.0f, 2.0f}) {
  test::check_oracle(anisotropic_diffusion, anisotropic_diffusion_oracle,
                     DofInput{scene, {.coc = lens, .max_coc_px = max_coc}, {}});
}

// 12 (z - 2) / z is `radius` at 2 / (1 - radius / 12) metres.
Image point_image(int size, float radius_px, float light) {
  Image image = make_image(Format::rgba16f, size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const float value = x == size / 2 && y == size / 2 ? light : 0.0f;
      store_texel(image, x, y, {value, value, value, 2.0f / (1.0f - radius_px / 12.0f)}, {});
    }
  }
  return image;
}

Image filtered(const Image& scene, const PixelCoc& lens, float max_coc) {
  ThreadPool pool(2);
  Image result = make_image(scene.format, scene.width, scene.height);
  anisotropic_diffusion({scene, {.coc = lens, .max_coc_px = max_coc}, {}}, result, pool);
  return result;
}

void check_bar_at(int at) {
  Image scene = random_scene_image(301, 157, 3);
  set_depth(scene, [&](int x, int y) {
    return x >= at && x < at + 5 && y >= at / 2 && y < at / 2 + 60 ? 9.0f : 2.0f;
  });
  check_oracle(scene, 12.0f);
}

}  // namespace

TEST_CASE("anisotropic diffusion gives its oracle's bits, at any size and radius") {
  struct Size {
    int width, height;
  };
  for (const Size size : {Size{1, 1}, {1, 50}, {50, 1}, {3, 2}, {96, 48}, {97, 49}, {211, 107}}) {
    for (const float max_coc : {0.0f, 0.4f, 0.6f, 2.0f, 5.3f, 10.0f}) {
      if (kHasSanitizers && size.width * size.height > 5000 && max_coc != 5.3f) continue;
      check_oracle(random_scene_image(size.width, size.height, 1), max_coc);
    }
  }
  check_oracle(random_scene_image(53, 31, 2), 100.0f, {1e5f, 2.0f});
}

TEST_CASE("anisotropic diffusion gives its oracle's bits where most of a picture is in focus") {
  check_bar_at(94);
}

TEST_CASE("so it does wherever what is blurred lies" * doctest::test_suite("long")) {
  for (const int at : {0, 96, 150}) check_bar_at(at);
}

TEST_CASE("the stages of anisotropic diffusion grow with the radius, and none is needed in focus") {
  CHECK(diffusion_stages(0.0f) == 0);
  CHECK(diffusion_stages(0.5f) == 0);
  CHECK(diffusion_stages(0.6f) == 1);
  for (const float radius_px : {1.0f, 3.0f, 16.0f, 64.0f, 1024.0f}) {
    const double stages = diffusion_stages(radius_px);
    const double square = static_cast<double>(radius_px) * static_cast<double>(radius_px);
    CHECK(stages * (stages + 2.0) - 1.0 >= 2.0 * square);
    CHECK(stages <= 1.42 * static_cast<double>(radius_px) + 1.0);
  }
}

TEST_CASE("anisotropic diffusion spreads a point evenly over a disc, not as a Gaussian") {
  const int size = 129;
  const float radius_px = 24.0f;
  const Image result = filtered(point_image(size, -radius_px, 4000.0f), {12.0f, 2.0f}, 64.0f);
  // Means of light by eighths of the radius; in a disc all are 1, and 0 outside.
  double light[10] = {}, count[10] = {};
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double distance = std::hypot(x - size / 2, y - size / 2) / 24.0;
      const int ring = std::min(static_cast<int>(8.0 * distance), 9);
      light[ring] += static_cast<double>(load_texel(result, x, y).x) / 4000.0;
      count[ring] += 1.0;
      CHECK(load_texel(result, x, y).x >= 0.0f);
    }
  }
  const double area = 3.14159 * 24.0 * 24.0;
  for (int i = 0; i < 7; ++i) {
    INFO("ring ", i);
    CHECK(light[i] / count[i] * area == doctest::Approx(1.0).epsilon(0.2));
  }
  CHECK(light[9] / count[9] * area < 0.01);
}

TEST_CASE("anisotropic diffusion keeps the sum of all light, at any depths") {
  const Image scene = random_scene_image(120, 90, 4);
  const Image result = filtered(scene, {30.0f, 2.0f}, 20.0f);
  double before = 0.0, after = 0.0;
  for (int y = 0; y < 90; ++y) {
    for (int x = 0; x < 120; ++x) {
      before += static_cast<double>(load_texel(scene, x, y).y);
      after += static_cast<double>(load_texel(result, x, y).y);
    }
  }
  CHECK(after / before == doctest::Approx(1.0).epsilon(2e-4));
}

TEST_CASE("anisotropic diffusion stays between the darkest and the brightest colour") {
  for (const float max_coc : {0.8f, 3.0f, 17.0f}) {
    const Image scene = random_scene_image(150, 90, 5);
    const Image result = filtered(scene, {40.0f, 2.0f}, max_coc);
    float least = 1.0f, most = 0.0f, least_after = 1.0f, most_after = 0.0f;
    for (int y = 0; y < 90; ++y) {
      for (int x = 0; x < 150; ++x) {
        const float value = load_texel(scene, x, y).x, after = load_texel(result, x, y).x;
        least = std::min(least, value), most = std::max(most, value);
        least_after = std::min(least_after, after), most_after = std::max(most_after, after);
      }
    }
    CHECK(least_after >= least - 1e-3f);
    CHECK(most_after <= most + 1e-3f);
  }
}

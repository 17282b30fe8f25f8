// The claims of dof/mipmap that other methods do not make.

#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "dof/mipmap/mip_levels.h"
#include "dof/mipmap/mipmap.h"
#include "raster/images/texel.h"
#include "tests/support/method_checks.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

constexpr PixelCoc kLens{40.0f, 2.0f};

Image filtered(const Image& scene, float max_coc, const PixelCoc& lens = kLens) {
  ThreadPool pool(2);
  Image result = random_scene_image(scene.width, scene.height, 99);
  mipmap({scene, {.coc = lens, .max_coc_px = max_coc}, {}}, result, pool);
  return result;
}

void check_oracle(const Image& scene, float max_coc, const PixelCoc& lens = kLens) {
  test::check_oracle(mipmap, mipmap_oracle,
                     DofInput{scene, {.coc = lens, .max_coc_px = max_coc}, {}});
}

}  // namespace

TEST_CASE("mipmap gives its oracle's bits, at any size and radius" * doctest::test_suite("long")) {
  struct Size {
    int width, height;
  };
  for (const Size size : {Size{1, 1}, {1, 50}, {50, 1}, {3, 2}, {64, 32}, {65, 33}, {149, 83}}) {
    for (const float max_coc : {0.0f, 0.9f, 7.25f, 60.0f, 1024.0f}) {
      check_oracle(random_scene_image(size.width, size.height, 1), max_coc);
    }
  }
  check_oracle(random_scene_image(67, 41, 2), 1024.0f, {1e5f, 2.0f});
}

TEST_CASE("mipmap gives its oracle's bits where hardly anything lies before the focus" *
          doctest::test_suite("long")) {
  for (const float depth_m : {1.9f, 1.0f, 0.5f, 4.0f}) {
    Image scene = random_scene_image(201, 97, 3);
    set_depth(scene, [&](int x, int y) { return x == 80 && y == 40 ? depth_m : 2.0f; });
    check_oracle(scene, 64.0f);
    set_depth(scene, [&](int x, int y) { return x == 0 || y == 96 ? depth_m : 9.0f; });
    check_oracle(scene, 64.0f);
  }
}

TEST_CASE("a mip ladder's filters weigh 1 in all, and their rungs double in area") {
  const std::vector<MipLevelRungs> ladder = make_mip_ladder(100.0f);
  float before = 0.5f;
  for (const MipLevelRungs& level : ladder) {
    for (const MipRung& rung : level.rungs) {
      double sum = 0.0;
      for (int y = -rung.reach; y <= rung.reach; ++y) {
        for (int x = -rung.reach; x <= rung.reach; ++x) {
          sum += static_cast<double>(rung.weights[std::abs(y)][std::abs(x)]);
        }
      }
      CHECK(sum == doctest::Approx(1.0).epsilon(1e-6));
      if (rung.square == 0.0f) continue;
      CHECK(rung.square == 2.0f * before);
      before = rung.square;
    }
  }
  CHECK(before >= 10000.0f);
}

TEST_CASE("mipmap keeps a point's light and its circle's second moment from 1 to 64 pixels") {
  for (const float radius_px : {1.0f, 1.7f, 3.0f, 5.0f, 9.0f, 16.0f, 27.0f, 64.0f}) {
    for (const bool near : {false, true}) {
      const int size = 384, middle = 191;
      Image scene = make_image(Format::rgba16f, size, size);
      const float depth_m = near ? 1.0f : 1e4f;
      for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
          const float light = x == middle && y == middle ? 60000.0f : 0.0f;
          store_texel(scene, x, y, {light, light, light, depth_m}, {});
        }
      }
      const Image result = filtered(scene, 100.0f, {near ? radius_px : radius_px, 2.0f});
      double light = 0.0, x_mean = 0.0, y_mean = 0.0, square = 0.0;
      for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
          const auto value = static_cast<double>(load_texel(result, x, y).y);
          light += value;
          x_mean += value * x;
          y_mean += value * y;
          square += value * (x * x + y * y);
        }
      }
      x_mean /= light;
      y_mean /= light;
      const double moment = square / light - x_mean * x_mean - y_mean * y_mean;
      INFO(radius_px, near ? " before" : " behind");
      CHECK(light / 60000.0 == doctest::Approx(1.0).epsilon(0.003));
      CHECK(std::sqrt(2.0 * moment) / static_cast<double>(radius_px) ==
            doctest::Approx(1.0).epsilon(0.02));
    }
  }
}

TEST_CASE("mipmap fades a thin blurred bar, and the sharp wall goes on behind it") {
  Image scene = make_image(Format::rgba16f, 200, 60);
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 200; ++x) {
      const bool bar = x >= 98 && x < 102;
      const float light = bar ? 0.0f : 1.0f;
      // 20 (z - 2) / z is -20 at 1 m.
      store_texel(scene, x, y, {light, light, light, bar ? 1.0f : 2.0f}, {});
    }
  }
  const Image result = filtered(scene, 64.0f, {20.0f, 2.0f});
  // Chords of a disc: a bar of width w before a disc of radius r hides 2 w / (pi r) in its middle.
  const float hidden = 1.0f - load_texel(result, 100, 30).x;
  CHECK(hidden == doctest::Approx(2.0 * 4.0 / (3.14159 * 20.0)).epsilon(0.35));
  CHECK(load_texel(result, 60, 30).x == doctest::Approx(1.0).epsilon(0.01));
}

TEST_CASE("mipmap keeps the other colour of a half behind an opaque near half") {
  // Deep inside, nothing shows through.
  Image scene = make_image(Format::rgba16f, 200, 60);
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 200; ++x) {
      const float light = x < 100 ? 0.25f : 10.0f;
      store_texel(scene, x, y, {light, light, light, x < 100 ? 1.0f : 2.0f}, {});
    }
  }
  const Image result = filtered(scene, 64.0f, {12.0f, 2.0f});
  CHECK(load_texel(result, 60, 30).x == doctest::Approx(0.25).epsilon(0.001));
  CHECK(load_texel(result, 140, 30).x == 10.0f);
  CHECK(load_texel(result, 100, 30).x > 2.0f);
  CHECK(load_texel(result, 100, 30).x < 8.0f);
}

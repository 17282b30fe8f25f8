#include "scenes/lens_views/ray_traced.h"

#include <doctest/doctest.h>

#include "dof/measure/difference.h"
#include "scenes/load/load_scene.h"
#include "tests/support/lens_view_scenes.h"
#include "tests/support/skip.h"

using namespace softfocus;
using test::Drawn;
using test::sample_scene;

namespace {

bool is_missing() {
  if (ray_traced_missing().empty()) return false;
  skip("embree", ray_traced_missing());
  return true;
}

/// The mean of a - b over pixels whose circle of confusion lies in a range, how far that
/// may be from 0 by chance (the standard error), and how many pixels they are.
struct RegionMean {
  double difference = 0.0;
  double by_chance = 0.0;
  int pixels = 0;
};
RegionMean mean_difference(const Image& a, const Image& b, const PixelCoc& coc, double least_px,
                           double most_px) {
  RegionMean mean;
  double squares = 0.0;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      const glm::vec4 in_a = load_texel(a, x, y), in_b = load_texel(b, x, y);
      const double radius = coc_radius_px(coc, in_a.w);
      if (radius < least_px || radius >= most_px) continue;
      const glm::vec4 difference = in_a - in_b;
      const double of_pixel = (difference.x + difference.y + difference.z) / 3.0;
      mean.difference += of_pixel;
      squares += of_pixel * of_pixel;
      ++mean.pixels;
    }
  }
  if (mean.pixels > 0) {
    mean.difference /= mean.pixels;
    mean.by_chance = std::sqrt(squares) / mean.pixels;
  }
  return mean;
}

}  // namespace

TEST_CASE("ray-traced: the image of a point is the aperture, as large as the lens says" *
          doctest::test_suite("long")) {
  if (is_missing()) return;
  test::check_image_of_point("ray-traced", 1.0, 0);
  test::check_image_of_point("ray-traced", 8.0, 0);
  test::check_image_of_point("ray-traced", 8.0, 5);
}

TEST_CASE("ray-traced: what lies in the plane of focus is as sharp as the pinhole has it") {
  if (is_missing()) return;
  ThreadPool pool{2};
  const Scene scene = test::square_scene(test::kTestLens.focus_m, 0.8);
  const Drawn drawn = sample_scene(scene, "ray-traced", {.samples = 16}, 65, 65, pool);
  CHECK(equal(drawn.sampled.picture, drawn.pinhole));
}

TEST_CASE("ray-traced: holes in the plane of focus are as sharp as the pinhole has them") {
  if (is_missing()) return;
  ThreadPool pool{2};
  const Scene scene = test::lattice_scene(test::kTestLens.focus_m, 0.8);
  const Drawn drawn = sample_scene(scene, "ray-traced", {.samples = 16}, 65, 65, pool);
  CHECK(equal(drawn.sampled.picture, drawn.pinhole));
  CHECK(load_texel(drawn.pinhole, 26, 26).x == 1.0f);
  CHECK(load_texel(drawn.pinhole, 26, 36).x == 0.0f);
}

TEST_CASE("ray-traced: one-sided surfaces are seen from their fronts alone, mirrored ones too") {
  if (is_missing()) return;
  ThreadPool pool{1};
  for (const bool two_sided : {false, true}) {
    for (const double mirror : {1.0, -1.0}) {
      for (const double turned : {0.0, 180.0}) {
        Scene scene = test::square_scene(2.0, 0.8);
        scene.materials[0].two_sided = two_sided;
        scene.objects[0].scale.x *= mirror;
        scene.objects[0].rotation_degrees.y = turned;
        const Drawn drawn = sample_scene(scene, "ray-traced", {.samples = 2}, 33, 33, pool);
        CHECK(equal(drawn.sampled.picture, drawn.pinhole));
      }
    }
  }
}

TEST_CASE("ray-traced: the same bits for any number of threads" * doctest::test_suite("threads")) {
  if (is_missing()) return;
  const Scene scene = load_scene("figures", scene_search_path({}));
  const Sampling sampling{.samples = 20, .jitter = true, .aperture = {7}};
  ThreadPool one{1};
  const Drawn expected = sample_scene(scene, "ray-traced", sampling, 96, 64, one, scene.lens.lens);
  for (const int threads : {2, 3}) {
    ThreadPool pool{threads};
    CHECK(equal(
        sample_scene(scene, "ray-traced", sampling, 96, 64, pool, scene.lens.lens).sampled.picture,
        expected.sampled.picture));
  }
}

TEST_CASE("ray-traced: it agrees with accumulation on each scene, and what is left is no bias" *
          doctest::test_suite("long")) {
  if (is_missing()) return;
  ThreadPool pool{2};
  for (const char* name : {"figures", "cube-room", "sphere-world", "canopy", "glass"}) {
    const Scene scene = load_scene(name, scene_search_path({}));
    const Sampling sampling{.samples = 256};
    const auto by = [&](const char* method) {
      return sample_scene(scene, method, sampling, 128, 128, pool, scene.lens.lens).sampled.picture;
    };
    const Image accumulated = by("accumulation");
    const Image traced = by("ray-traced");
    const double psnr_db = compare_images(accumulated, traced).psnr_db;
    CHECK(psnr_db > 50.0);
    const PixelCoc coc = pixel_coc(scene.lens.lens, scene.camera.fov_y_degrees, 128, 1.0);
    constexpr double kFar = 1e9;
    const RegionMean nearer = mean_difference(traced, accumulated, coc, -kFar, -0.5);
    const RegionMean focused = mean_difference(traced, accumulated, coc, -0.5, 0.5);
    const RegionMean farther = mean_difference(traced, accumulated, coc, 0.5, kFar);
    MESSAGE(scene.name << ": " << psnr_db << " dB");
    for (const RegionMean& region : {nearer, focused, farther}) {
      MESSAGE(region.pixels << " pixels differ in the mean by " << region.difference
                            << ", by chance " << region.by_chance);
      CHECK(std::fabs(region.difference) < 2e-5 + 4.0 * region.by_chance);
    }
  }
}

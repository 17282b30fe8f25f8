#include "scenes/lens_views/accumulation.h"

#include <doctest/doctest.h>

#include "scenes/lens_views/few_pixel_offsets.h"
#include "scenes/lens_views/lens_points.h"
#include "scenes/lens_views/sample_sums.h"
#include "scenes/load/load_scene.h"
#include "tests/support/lens_view_scenes.h"

using namespace softfocus;
using test::Drawn;
using test::sample_scene;
using test::square_scene;

namespace {

Drawn accumulated(const Scene& scene, const Sampling& sampling, int width, int height,
                  ThreadPool& pool) {
  return sample_scene(scene, "accumulation", sampling, width, height, pool, scene.lens.lens);
}

Scene built_in(const char* name) { return load_scene(name, scene_search_path({})); }

}  // namespace

TEST_CASE("accumulation: one sample is the pinhole's picture") {
  ThreadPool pool{2};
  for (const char* name : {"figures", "cube-room", "sphere-world", "canopy", "glass"}) {
    const Drawn drawn = accumulated(built_in(name), {.samples = 1}, 96, 64, pool);
    CHECK(equal(drawn.sampled.picture, drawn.pinhole));
    CHECK(drawn.sampled.samples == 1);
  }
}

TEST_CASE("accumulation: the image of a point is the aperture, as large as the lens says") {
  test::check_image_of_point("accumulation", 1.0, 0);
  test::check_image_of_point("accumulation", 8.0, 0);
  test::check_image_of_point("accumulation", 1.0, 6);
  test::check_image_of_point("accumulation", 8.0, 5);
}

TEST_CASE("accumulation: what lies in the plane of focus is as sharp as the pinhole has it") {
  ThreadPool pool{2};
  const Scene scene = square_scene(test::kTestLens.focus_m, 0.8);
  const Drawn drawn = sample_scene(scene, "accumulation", {.samples = 64}, 65, 65, pool);
  CHECK(equal(drawn.sampled.picture, drawn.pinhole));
}

TEST_CASE("accumulation: holes in the plane of focus are as sharp as the pinhole has them") {
  ThreadPool pool{2};
  const Scene scene = test::lattice_scene(test::kTestLens.focus_m, 0.8);
  const Drawn drawn = sample_scene(scene, "accumulation", {.samples = 64}, 65, 65, pool);
  CHECK(equal(drawn.sampled.picture, drawn.pinhole));
  CHECK(load_texel(drawn.pinhole, 26, 26).x == 1.0f);
  CHECK(load_texel(drawn.pinhole, 26, 36).x == 0.0f);
}

TEST_CASE("accumulation: the same bits for any number of threads and on every vector unit" *
          doctest::test_suite("threads long")) {
  const Scene scene = built_in("figures");
  const Sampling sampling{.samples = 50, .jitter = true, .until = 1e-6, .aperture = {7}};
  ThreadPool one{1};
  const Drawn expected = accumulated(scene, sampling, 96, 64, one);
  for (const int threads : {2, 3}) {
    ThreadPool pool{threads};
    const Drawn drawn = accumulated(scene, sampling, 96, 64, pool);
    CHECK(equal(drawn.sampled.picture, expected.sampled.picture));
    CHECK(drawn.sampled.half_set_rms == expected.sampled.half_set_rms);
  }
  for (const Isa isa : available_isas()) {
    ThreadPool pool{1, isa};
    CHECK(equal(accumulated(scene, sampling, 96, 64, pool).sampled.picture,
                expected.sampled.picture));
  }
}

TEST_CASE("accumulation: it is the mean of the pictures that draw_scene() makes" *
          doctest::test_suite("long")) {
  const int width = 150, height = 70;  // parts of tiles
  const Profile profile{};
  for (const char* name : {"sphere-world", "canopy", "glass"}) {
    const Scene scene = built_in(name);
    const CameraMatrices pinhole_camera = camera_matrices(scene.camera, 0.0, width, height);
    const double radius_m = aperture_radius_m(scene.lens.lens, 1.0);
    for (const int samples :
         {kSampleGroup, 2 * kLensViewGroup + kSampleGroup + 3, kMostFewLensPoints + 1}) {
      ThreadPool pool{2};
      const Sampling sampling{.samples = samples, .jitter = true};
      const Drawn drawn = accumulated(scene, sampling, width, height, pool);

      const auto points = view_points(sampling);
      CHECK((points == lens_points({}, samples)) == (samples > kMostFewLensPoints));
      const auto offsets = view_offsets(true, points);
      SampleSums sums = make_sample_sums(width, height);
      std::vector<Image> group;
      for (std::size_t i = 0; i < points.size(); ++i) {
        const CameraMatrices camera =
            lens_camera(pinhole_camera, points[i] * radius_m, scene.lens.lens.focus_m, offsets[i],
                        width, height);
        group.push_back(draw_scene(scene, camera, 0.0, width, height, profile, pool));
        if (group.size() < kSampleGroup && i + 1 < points.size()) continue;
        add_pictures(group, sums, pool);
        group.clear();
      }
      CHECK(equal(drawn.sampled.picture, mean_picture(sums, drawn.pinhole, profile, pool)));
    }
  }
}

TEST_CASE("accumulation: alpha is the pinhole's depth") {
  ThreadPool pool{2};
  const Drawn drawn = accumulated(built_in("figures"), {.samples = 9}, 96, 64, pool);
  CHECK(!equal(drawn.sampled.picture, drawn.pinhole));
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 96; ++x) {
      CHECK(load_texel(drawn.sampled.picture, x, y).w == load_texel(drawn.pinhole, x, y).w);
    }
  }
}

TEST_CASE("accumulation: jitter gives pixels on an edge the part that is covered") {
  ThreadPool pool{2};
  // In the plane of focus, and 20.25 pixels wide.
  const double pixel_m = 2.0 * 2.0 * std::tan(20.0 * 3.14159265358979323846 / 180.0) / 64;
  const Scene scene = square_scene(2.0, 20.25 * pixel_m);
  const Sampling sampling{.samples = 256, .jitter = true};
  const Image picture = sample_scene(scene, "accumulation", sampling, 64, 64, pool).sampled.picture;
  CHECK(load_texel(picture, 22, 32).x == 1.0f);
  CHECK(load_texel(picture, 21, 32).x == doctest::Approx(0.125).epsilon(0.05));
  CHECK(load_texel(picture, 20, 32).x == 0.0f);
}

TEST_CASE("accumulation: it stops when the half-sets agree to the error asked for") {
  ThreadPool pool{2};
  const Scene scene = built_in("figures");
  const Drawn stopped = accumulated(scene, {.samples = 4096, .until = 0.004}, 96, 64, pool);
  const int samples = stopped.sampled.samples;
  CHECK(samples >= 32);
  CHECK(samples < 4096);
  CHECK((samples & (samples - 1)) == 0);
  CHECK(stopped.sampled.half_set_rms.value() <= 0.004);
  CHECK(
      equal(stopped.sampled.picture,
            accumulated(scene, {.samples = samples, .until = 0.0}, 96, 64, pool).sampled.picture));
  const Drawn before = accumulated(scene, {.samples = samples / 2, .until = 0.004}, 96, 64, pool);
  CHECK(before.sampled.half_set_rms.value() > 0.004);
}

TEST_CASE("accumulation: it tells how far it is") {
  ThreadPool pool{1};
  const Scene scene = square_scene(2.0, 1.0);
  const CameraMatrices camera = camera_matrices(scene.camera, 0.0, 16, 16);
  const Image pinhole = draw_scene(scene, camera, 0.0, 16, 16, Profile{}, pool);
  std::vector<int> told;
  accumulation({scene,
                camera,
                0.0,
                pinhole,
                2.0,
                0.01,
                {.samples = 20},
                Profile{},
                [&](int samples) { told.push_back(samples); }},
               pool);
  CHECK(told == std::vector{8, 16, 20});
}

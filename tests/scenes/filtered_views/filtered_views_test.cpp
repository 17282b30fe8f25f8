#include "scenes/filtered_views/filtered_views.h"

#include <doctest/doctest.h>

#include "dof/measure/flip.h"
#include "scenes/lens_views/accumulation.h"
#include "scenes/load/load_scene.h"
#include "tests/support/lens_view_scenes.h"

using namespace softfocus;
using test::Drawn;
using test::sample_scene;
using test::square_scene;

namespace {

Drawn filtered(const Scene& scene, const Sampling& sampling, int width, int height,
               ThreadPool& pool) {
  return sample_scene(scene, "filtered-views", sampling, width, height, pool, scene.lens.lens);
}

Scene scene_named(const char* name) { return load_scene(name, scene_search_path({})); }

}  // namespace

TEST_CASE("filtered views: what lies in the plane of focus is as sharp as the pinhole has it") {
  ThreadPool pool{2};
  const Scene scene = square_scene(test::kTestLens.focus_m, 0.8);
  const Drawn drawn = sample_scene(scene, "filtered-views", {.samples = 8}, 65, 65, pool);
  CHECK(equal(drawn.sampled.picture, drawn.pinhole));
  CHECK(drawn.sampled.samples == 8);
}

TEST_CASE("filtered views: the mean of the views, each as the oracle spreads it") {
  const Scene scene = scene_named("sphere-world");
  const int width = 150, height = 70;  // parts of tiles
  const Profile profile{};
  ThreadPool pool{2};
  for (const int samples : {1, 3, 11}) {
    const Sampling sampling{.samples = samples, .jitter = true};
    const Drawn drawn = filtered(scene, sampling, width, height, pool);

    const CameraMatrices pinhole_camera = camera_matrices(scene.camera, 0.0, width, height);
    const double radius_m = aperture_radius_m(scene.lens.lens, 1.0);
    const LensCells cells = lens_cells({}, samples, points_of_cell(samples), true);
    const PixelCoc coc = pixel_coc(scene.lens.lens, scene.camera.fov_y_degrees, height, 1.0);
    const ViewSpread spread = make_view_spread(coc, cells);
    const auto pixels = static_cast<std::size_t>(width * height);
    std::vector<double> totals(3 * pixels);
    ColourPlanes group;
    for (int i = 0; i < samples; ++i) {
      const auto number = static_cast<std::size_t>(i);
      const CameraMatrices camera =
          lens_camera(pinhole_camera, cells.views[number] * radius_m, scene.lens.lens.focus_m,
                      cells.in_pixel[number], width, height);
      const Image view = draw_scene(scene, camera, 0.0, width, height, profile, pool);
      const ColourPlanes planes = spread_view_oracle(
          view, spread, ray_steps(spread, points_of(cells, i), cells.in_pixel[number]),
          cells.per_cell);
      if (i % kSampleGroup == 0) {
        group = planes;
      } else {
        for (std::size_t k = 0; k < planes.size(); ++k) group[k] += planes[k];
      }
      if (i % kSampleGroup != kSampleGroup - 1 && i + 1 != samples) continue;
      for (std::size_t k = 0; k < planes.size(); ++k) totals[k] += static_cast<double>(group[k]);
    }
    Image expected = make_image(Format::rgba16f, width, height);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        glm::vec4 texel{0.0f, 0.0f, 0.0f, load_texel(drawn.pinhole, x, y).w};
        for (int c = 0; c < 3; ++c) {
          texel[c] = static_cast<float>(totals[static_cast<std::size_t>(c) * pixels +
                                               static_cast<std::size_t>(y * width + x)] /
                                        samples);
        }
        store_texel<Format::rgba16f>(expected, x, y, texel, profile);
      }
    }
    CHECK(equal(drawn.sampled.picture, expected));
  }
}

TEST_CASE("filtered views: the same bits for any number of threads and on every vector unit" *
          doctest::test_suite("threads long")) {
  const Scene scene = scene_named("figures");
  const Sampling sampling{.samples = 19, .jitter = true, .aperture = {7}};
  ThreadPool one{1};
  const Drawn expected = filtered(scene, sampling, 96, 64, one);
  for (const int threads : {2, 3}) {
    ThreadPool pool{threads};
    CHECK(equal(filtered(scene, sampling, 96, 64, pool).sampled.picture, expected.sampled.picture));
  }
  for (const Isa isa : available_isas()) {
    ThreadPool pool{1, isa};
    CHECK(equal(filtered(scene, sampling, 96, 64, pool).sampled.picture, expected.sampled.picture));
  }
}

TEST_CASE("filtered views: nearer to the truth than as many views unfiltered" *
          doctest::test_suite("long")) {
  ThreadPool pool{2};
  for (const char* name : {"figures", "sphere-world", "near-fence"}) {
    const Scene scene = scene_named(name);
    const auto flip = [&](const char* method, int samples, const Image& truth) {
      return mean_flip(
          truth,
          sample_scene(scene, method, {.samples = samples}, 192, 192, pool, scene.lens.lens)
              .sampled.picture,
          pool);
    };
    const Image truth =
        sample_scene(scene, "accumulation", {.samples = 1024}, 192, 192, pool, scene.lens.lens)
            .sampled.picture;
    for (const int samples : {4, 8}) {
      CAPTURE(name);
      CAPTURE(samples);
      CHECK(flip("filtered-views", samples, truth) < flip("accumulation", samples, truth));
    }
  }
}

TEST_CASE("filtered views: where views are many, no farther from the truth than unfiltered ones" *
          doctest::test_suite("long")) {
  ThreadPool pool{2};
  for (const char* name : {"cube-room", "random:101", "random:202"}) {
    const Scene scene = scene_named(name);
    const auto picture = [&](const char* method, int samples) {
      return sample_scene(scene, method, {.samples = samples}, 256, 256, pool, scene.lens.lens)
          .sampled.picture;
    };
    const Image truth = picture("accumulation", 1024);
    for (const int samples : {12, 16, 24, 32}) {
      CAPTURE(name);
      CAPTURE(samples);
      CHECK(mean_flip(truth, picture("filtered-views", samples), pool) <
            1.01 * mean_flip(truth, picture("accumulation", samples), pool));
    }
  }
}

TEST_CASE("filtered views: many of them are accumulation") {
  ThreadPool pool{2};
  const Scene scene = scene_named("cube-room");
  const Sampling sampling{.samples = 150};
  CHECK(equal(filtered(scene, sampling, 40, 30, pool).sampled.picture,
              sample_scene(scene, "accumulation", sampling, 40, 30, pool, scene.lens.lens)
                  .sampled.picture));
}

TEST_CASE("filtered views: they are doubled until the picture hardly changes") {
  ThreadPool pool{2};
  const Scene scene = scene_named("figures");
  const Drawn stopped = filtered(scene, {.samples = 4096, .until = 0.01}, 96, 64, pool);
  const int samples = stopped.sampled.samples;
  CHECK(samples >= 16);
  CHECK(samples < 4096);
  CHECK(stopped.sampled.half_set_rms.value() <= 0.01);
  CHECK(equal(stopped.sampled.picture,
              filtered(scene, {.samples = samples}, 96, 64, pool).sampled.picture));
  const Drawn cut = filtered(scene, {.samples = 12, .until = 1e-9}, 96, 64, pool);
  CHECK(cut.sampled.samples == 12);
  CHECK(!cut.sampled.half_set_rms);
}

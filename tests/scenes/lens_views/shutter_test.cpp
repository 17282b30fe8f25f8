// accumulation() while the shutter is open.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "scenes/lens_views/accumulation.h"
#include "scenes/lens_views/few_pixel_offsets.h"
#include "scenes/lens_views/sample_sums.h"
#include "scenes/lens_views/shard.h"
#include "scenes/lens_views/shutter_times.h"
#include "scenes/load/load_scene.h"
#include "tests/support/lens_view_scenes.h"
#include "tests/support/sanitizers.h"

using namespace softfocus;
using test::square_scene;

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kDepth = 2.0;

// A pixel's size on square_scene() at kDepth, in a picture of that height.
double pixel_m(int height) { return 2.0 * kDepth * std::tan(kPi / 9.0) / height; }

/// The picture of `frame`, and its aperture's radius in metres.
struct Taken {
  int width = 64, height = 64;
  double frame = 0.0;
  double radius_m = 0.0;
};

/// accumulation()'s arguments beside its sampling.
struct View {
  CameraMatrices camera;
  Image pinhole;
};

View view_of(const Scene& scene, const Taken& taken, ThreadPool& pool) {
  const CameraMatrices camera =
      camera_matrices(scene.camera, taken.frame, taken.width, taken.height);
  return {camera,
          draw_scene(scene, camera, taken.frame, taken.width, taken.height, Profile{}, pool)};
}

LensViewInput input_of(const Scene& scene, const Taken& taken, const View& view,
                       const Sampling& sampling) {
  return {scene,    view.camera, taken.frame, view.pinhole, kDepth, taken.radius_m,
          sampling, Profile{},   {}};
}

Image exposed(const Scene& scene, const Taken& taken, const Sampling& sampling, ThreadPool& pool) {
  const View view = view_of(scene, taken, pool);
  return accumulation(input_of(scene, taken, view, sampling), pool).picture;
}

/// A square of `width_px` that moves to the right by `speed_px` a frame: a part of so long a sway
/// that it is even to 1e-7.
Scene moving_square(double width_px, double speed_px, int height) {
  Scene scene = square_scene(kDepth, width_px * pixel_m(height));
  Object& object = scene.objects[0];
  object.sway_period_frames = 1e4;
  object.sway.x = speed_px * pixel_m(height) * object.sway_period_frames / (2.0 * kPi);
  return scene;
}

double red_at(const Image& picture, int x, int y) {
  return static_cast<double>(load_texel<Format::rgba16f>(picture, x, y).x);
}

double sum_of_red(const Image& picture) { return test::moments(picture).sum; }

Scene turning_and_crossing() {
  Scene scene = load_scene("glass", scene_search_path({}));
  scene.camera.orbit_degrees_per_frame = 3.0;
  for (Object& object : scene.objects) object.spin_degrees_per_frame = {1.0, 2.0, 3.0};
  return scene;
}

}  // namespace

TEST_CASE("shutter: one view is the pinhole's picture") {
  ThreadPool pool{2};
  const Scene scene = turning_and_crossing();
  const Taken taken{.width = 48, .height = 32, .frame = 3.0, .radius_m = 0.01};
  CHECK(equal(exposed(scene, taken, {.samples = 1, .shutter_frames = 1.0}, pool),
              view_of(scene, taken, pool).pinhole));
}

TEST_CASE("shutter: a scene that stands still is what it is without") {
  ThreadPool pool{2};
  const Scene scene = load_scene("figures", scene_search_path({}));
  const Taken taken{.width = 48, .height = 32, .radius_m = 0.01};
  for (const Sampling& sampling :
       {Sampling{.samples = 20, .jitter = true}, Sampling{.samples = 300},
        Sampling{.samples = 40, .until = 0.01}, Sampling{.samples = 64, .by_tile = true}}) {
    Sampling open = sampling;
    open.shutter_frames = 1.0;
    CHECK(equal(exposed(scene, taken, open, pool), exposed(scene, taken, sampling, pool)));
  }
}

TEST_CASE("shutter: a thing that moves evenly covers its box of the time") {
  ThreadPool pool{2};
  constexpr int kViews = 256;
  // Narrower than its way, and wider.
  for (const double width_px : {6.0, 21.0}) {
    CAPTURE(width_px);
    constexpr double kWayPx = 12.0;
    const Scene scene = moving_square(width_px, kWayPx / 0.5, 64);
    const Image picture = exposed(scene, {}, {.samples = kViews, .shutter_frames = 0.5}, pool);
    for (int x = 0; x < 64; ++x) {
      // A pixel's centre is in the square while the square's centre is in this range.
      const double from = x + 0.5 - 32.0 - width_px / 2.0, to = from + width_px;
      const double covered =
          std::max(0.0, std::min(to, kWayPx / 2.0) - std::max(from, -kWayPx / 2.0)) / kWayPx;
      CAPTURE(x);
      // Each of two edges errs by a view at most, and by the rasterizer's 1/256 of a pixel.
      CHECK(std::fabs(red_at(picture, x, 32) - covered) < 2.0 / kViews + 2.0 / 256 / kWayPx);
    }
  }
}

TEST_CASE("shutter: the time is evenly spread with however few views and no lens") {
  ThreadPool pool{2};
  // A way of 16 pixels, and a step of 2 or 4 between the views.
  const Scene scene = moving_square(2.0, 16.0, 64);
  for (const int views : {4, 8}) {
    const Image picture = exposed(scene, {}, {.samples = views, .shutter_frames = 1.0}, pool);
    for (int x = 20; x < 44; ++x) {
      const double nearest = std::fabs(std::remainder(x + 0.5 - 32.0 - 8.0 / views, 16.0 / views));
      const bool on_the_way = std::fabs(x + 0.5 - 32.0) < 8.0 + 1.0 - 8.0 / views;
      CAPTURE(x);
      CAPTURE(views);
      if (std::fabs(nearest - 1.0) < 0.01) continue;  // an edge on the pixel's centre
      CHECK(red_at(picture, x, 32) == (on_the_way && nearest < 1.0 ? 1.0 / views : 0.0));
    }
  }
}

TEST_CASE("shutter: a bar that turns covers what it passes, by brute force") {
  ThreadPool pool{2};
  constexpr int kSize = 64, kTimes = 4096;
  constexpr double kDegrees = 40.0, kLong = 50.0, kThin = 5.0;
  Scene scene = square_scene(kDepth, pixel_m(kSize));
  scene.objects[0].scale = glm::dvec3{kLong, kThin, 1.0} * pixel_m(kSize);
  scene.objects[0].spin_degrees_per_frame.z = kDegrees;
  const Image picture = exposed(scene, {}, {.samples = 256, .shutter_frames = 1.0}, pool);
  double squares = 0.0, worst = 0.0;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const double right = x + 0.5 - kSize / 2.0, up = kSize / 2.0 - y - 0.5;
      int inside = 0;
      for (int i = 0; i < kTimes; ++i) {
        const double angle = kDegrees * ((i + 0.5) / kTimes - 0.5) * kPi / 180.0;
        const double along = right * std::cos(angle) + up * std::sin(angle);
        const double across = up * std::cos(angle) - right * std::sin(angle);
        inside += std::fabs(along) < kLong / 2.0 && std::fabs(across) < kThin / 2.0 ? 1 : 0;
      }
      const double error = red_at(picture, x, y) - inside / static_cast<double>(kTimes);
      squares += error * error;
      worst = std::max(worst, std::fabs(error));
    }
  }
  MESSAGE("RMS " << std::sqrt(squares) / kSize << ", worst " << worst);
  CHECK(std::sqrt(squares) / kSize < 0.002);
  CHECK(worst < 0.03);
}

TEST_CASE("shutter: motion takes nothing from the light and adds none") {
  ThreadPool pool{2};
  const Scene scene = moving_square(9.0, 20.0, 64);
  const double still = sum_of_red(exposed(scene, {}, {.samples = 64, .jitter = true}, pool));
  for (const double radius_m : {0.0, 0.05}) {
    const Image picture = exposed(scene, {.radius_m = radius_m},
                                  {.samples = 64, .jitter = true, .shutter_frames = 1.0}, pool);
    CHECK(sum_of_red(picture) == doctest::Approx(still).epsilon(0.002));
  }
}

TEST_CASE("shutter: it is the mean of the pictures that draw_scene() makes at its times") {
  const Scene scene = turning_and_crossing();
  const Taken taken{.width = 90, .height = 70, .frame = 2.0, .radius_m = 0.01};
  ThreadPool pool{2};
  const View view = view_of(scene, taken, pool);
  for (const int samples : {kLensViewGroup + 3, 260}) {
    if (kHasSanitizers && samples == 260) continue;
    const Sampling sampling{.samples = samples, .jitter = true, .shutter_frames = 0.75};
    const auto points = view_points(sampling);
    const auto offsets = view_offsets(true, points);
    const auto times = shutter_times(points, offsets);
    SampleSums sums = make_sample_sums(taken.width, taken.height);
    std::vector<Image> group;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double frame = taken.frame + 0.75 * times[i];
      const CameraMatrices camera =
          lens_camera(camera_matrices(scene.camera, frame, taken.width, taken.height),
                      points[i] * taken.radius_m, kDepth, offsets[i], taken.width, taken.height);
      group.push_back(draw_scene(scene, camera, frame, taken.width, taken.height, Profile{}, pool));
      if (group.size() < kSampleGroup && i + 1 < points.size()) continue;
      add_pictures(group, sums, pool);
      group.clear();
    }
    CHECK(equal(exposed(scene, taken, sampling, pool),
                mean_picture(sums, view.pinhole, Profile{}, pool)));
  }
}

TEST_CASE("shutter: the same bits for any number of threads and on every vector unit" *
          doctest::test_suite("threads long")) {
  const Scene scene = turning_and_crossing();
  const Taken taken{.width = 90, .height = 70, .frame = 2.0, .radius_m = 0.01};
  const Sampling sampling{.samples = 19, .jitter = true, .shutter_frames = 1.0};
  ThreadPool one{1};
  const Image expected = exposed(scene, taken, sampling, one);
  ThreadPool three{3};
  CHECK(equal(exposed(scene, taken, sampling, three), expected));
  for (const Isa isa : available_isas()) {
    ThreadPool pool{1, isa};
    CHECK(equal(exposed(scene, taken, sampling, pool), expected));
  }
}

TEST_CASE("shutter: the sums of shards are those of accumulation") {
  ThreadPool pool{2};
  const Scene scene = turning_and_crossing();
  const Taken taken{.width = 48, .height = 32, .radius_m = 0.01};
  const View view = view_of(scene, taken, pool);
  const LensViewInput input = input_of(scene, taken, view, {.samples = 44, .shutter_frames = 1.0});
  SampleSums joined = make_sample_sums(taken.width, taken.height);
  for (const int number : {2, 1, 3}) {
    const SampleSums part = accumulation_sums(input, samples_of({number, 3}, 44), pool);
    for (std::size_t i = 0; i < part.totals.size(); ++i) joined.totals[i] += part.totals[i];
    joined.count += part.count;
  }
  CHECK(equal(mean_picture(joined, view.pinhole, Profile{}, pool),
              accumulation(input, pool).picture));
}

TEST_CASE("shutter: by tile, a tile with things that move takes more views than one without") {
  ThreadPool pool{2};
  const Scene scene = moving_square(20.0, 20.0, 128);
  const Taken taken{.width = 128, .height = 128};
  const View view = view_of(scene, taken, pool);
  const SampledPicture sampled = accumulation(
      input_of(scene, taken, view, {.samples = 64, .by_tile = true, .shutter_frames = 1.0}), pool);
  CHECK(sampled.samples == 64);
  const Scene aside = [&] {
    Scene moved = scene;
    moved.objects[0].position += glm::dvec3{-32.0, 32.0, 0.0} * pixel_m(128);
    return moved;
  }();
  const View view_aside = view_of(aside, taken, pool);
  const SampledPicture one_tile = accumulation(
      input_of(aside, taken, view_aside, {.samples = 64, .by_tile = true, .shutter_frames = 1.0}),
      pool);
  CHECK(one_tile.mean_samples.value() == (64 + 3 * 8) / 4.0);
}

TEST_CASE("shutter: more views come nearer to the mean over lens and time" *
          doctest::test_suite("long")) {
  ThreadPool pool{2};
  const Scene scene = turning_and_crossing();
  const Taken taken{.width = 90, .height = 70, .frame = 2.0, .radius_m = 0.02};
  const auto picture_of = [&](int samples) {
    return exposed(scene, taken, {.samples = samples, .shutter_frames = 1.0}, pool);
  };
  const Image truth = picture_of(1024);
  const auto error_of = [&](int samples) {
    const Image picture = picture_of(samples);
    double squares = 0.0;
    for (int y = 0; y < taken.height; ++y) {
      for (int x = 0; x < taken.width; ++x) {
        const double error = red_at(picture, x, y) - red_at(truth, x, y);
        squares += error * error;
      }
    }
    return std::sqrt(squares);
  };
  const double few = error_of(8), more = error_of(32), many = error_of(128);
  MESSAGE(few << ", " << more << ", " << many);
  // Views at random would halve it each time.
  CHECK(more < 0.5 * few);
  CHECK(many < 0.5 * more);
}

#include "scenes/temporal/frame_history.h"

#include <doctest/doctest.h>

#include <cmath>
#include <glm/vec3.hpp>
#include <set>
#include <variant>

#include "raster/images/texel.h"
#include "scenes/load/load_scene.h"
#include "tests/support/lens_view_scenes.h"

using namespace softfocus;

namespace {

constexpr int kSide = 48;
constexpr HistoryBox kEachBox[] = {HistoryBox::none, HistoryBox::extent, HistoryBox::variance};

Scene figures() { return load_scene("figures", scene_search_path({})); }

Scene orbit_of_figures() {
  Scene scene = figures();
  scene.camera.orbit_degrees_per_frame = 1.0;
  return scene;
}

Image drawn(const Scene& scene, double frame, int side, ThreadPool& pool) {
  return draw_scene(scene, camera_matrices(scene.camera, frame, side, side), frame, side, side, {},
                    pool);
}

/// The mean of 8x8 pixels of a picture with 8 times the sides.
Image supersampled(const Scene& scene, ThreadPool& pool) {
  constexpr int kTimes = 8;
  const Image large = drawn(scene, 0.0, kTimes * kSide, pool);
  Image mean = make_image(Format::rgba16f, kSide, kSide);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      glm::vec4 sum{0.0f};
      for (int i = 0; i < kTimes * kTimes; ++i) {
        sum += load_texel(large, kTimes * x + i % kTimes, kTimes * y + i / kTimes);
      }
      store_texel(mean, x, y, sum / static_cast<float>(kTimes * kTimes), {});
    }
  }
  return mean;
}

double mean_square(const Image& a, const Image& b) {
  double sum = 0.0;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      const glm::vec4 off = load_texel(a, x, y) - load_texel(b, x, y);
      sum += static_cast<double>(off.x * off.x + off.y * off.y + off.z * off.z);
    }
  }
  return sum / (3.0 * a.width * a.height);
}

double psnr(const Image& a, const Image& b) { return -10.0 * std::log10(mean_square(a, b)); }

Image after_frames(const Scene& scene, const FrameEffect& effect, int frames, ThreadPool& pool,
                   double step = 1.0) {
  PreparedScene prepared = prepare_scene(scene, {}, pool);
  FrameHistory history;
  for (int i = 0; i < frames; ++i) {
    draw_next(prepared, effect, step * i, kSide, kSide, history, pool);
  }
  return history.picture;
}

}  // namespace

TEST_CASE("places in the pixel are spread evenly along both axes, about its centre") {
  for (const int count : {1, 3, 8, 16, 64}) {
    glm::dvec2 sum{0.0};
    std::set<double> columns, rows;
    for (const glm::dvec2& place : places_in_pixel(count)) {
      sum += place;
      columns.insert(place.x);
      rows.insert(place.y);
    }
    CHECK(sum == glm::dvec2{0.0});
    CHECK(columns.size() == static_cast<std::size_t>(count));
    CHECK(rows.size() == static_cast<std::size_t>(count));
    CHECK(*columns.begin() == doctest::Approx(0.5 / count - 0.5));
    CHECK(*rows.rbegin() == doctest::Approx(0.5 - 0.5 / count));
  }
}

TEST_CASE("temporal anti-aliasing of a still scene comes nearer to the supersampled picture") {
  ThreadPool pool{2};
  const Scene scene = figures();
  const Image truth = supersampled(scene, pool);
  for (const HistoryBox box : kEachBox) {
    const TemporalAa settings{{0.05f, box, 1.0f}, 16, {}};
    PreparedScene prepared = prepare_scene(scene, {}, pool);
    const auto after = [&](int frames) {
      return psnr(temporal_picture(prepared, settings, 0.0, frames, kSide, kSide, pool), truth);
    };
    const double first = after(1), second = after(2), fourth = after(4), last = after(16);
    CHECK(second > first);
    CHECK(fourth > second);
    CHECK(last > fourth);
    CHECK(last > first + (box == HistoryBox::none ? 9.0 : 5.0));
  }
}

TEST_CASE("eight frames of eight places are the mean of the eight pictures") {
  ThreadPool pool{2};
  const Scene scene = figures();
  PreparedScene prepared = prepare_scene(scene, {}, pool);
  const TemporalAa settings{{0.1f, HistoryBox::none}, 8, {}};
  const Image average = temporal_picture(prepared, settings, 0.0, 8, kSide, kSide, pool);
  const CameraMatrices centre = camera_matrices(scene.camera, 0.0, kSide, kSide);
  std::vector<glm::dvec3> sums(std::size_t{kSide} * kSide);
  const auto colour = [](const Image& image, std::size_t i) {
    return glm::dvec3{load_texel(image, static_cast<int>(i) % kSide, static_cast<int>(i) / kSide)};
  };
  for (const glm::dvec2& place : places_in_pixel(8)) {
    CameraMatrices view = centre;
    view.eye_to_clip[2][0] += 2.0 * place.x / kSide;
    view.eye_to_clip[2][1] += 2.0 * place.y / kSide;
    const Image one = draw_scene(scene, view, 0.0, kSide, kSide, {}, pool);
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += colour(one, i);
  }
  double worst = 0.0;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const glm::dvec3 off = sums[i] / 8.0 - colour(average, i);
    for (int c = 0; c < 3; ++c) worst = std::max(worst, std::fabs(off[c]));
  }
  // A half's rounding in each of seven frames.
  CHECK(worst < 7.0 * 0x1p-12);
}

TEST_CASE("from one place in the pixel a still scene stays as it is drawn, to the bit") {
  ThreadPool pool{2};
  const Image once = drawn(figures(), 0.0, kSide, pool);
  for (const HistoryBox box : {HistoryBox::none, HistoryBox::extent}) {
    CHECK(equal(after_frames(figures(), TemporalAa{{0.1f, box}, 1, {}}, 5, pool, 0.0), once));
  }
  CHECK(equal(after_frames(figures(), Refresh{5}, 4, pool, 0.0), once));
  for (const bool forward : {false, true}) {
    CHECK(equal(after_frames(figures(), Reproject{9, forward, UnseenPixels::black}, 4, pool, 0.0),
                once));
  }
}

TEST_CASE("what a moving surface uncovers is new, and has no trail of it") {
  // A square that sways to the right, before a wall.
  Scene scene = test::square_scene(4.0, 1.0);
  scene.objects[0].sway = {0.7, 0.0, 0.0};
  scene.objects[0].sway_period_frames = 4.0;
  scene.objects.push_back(scene.objects[0]);
  scene.objects[1].sway = {0.0, 0.0, 0.0};
  scene.objects[1].position = {0.0, 0.0, -4.0};
  scene.objects[1].scale = glm::dvec3{30.0};
  Material wall = scene.materials[0];
  wall.diffuse = glm::vec3{0.25f};
  scene.materials.push_back(wall);
  scene.objects[1].material = 1;
  ThreadPool pool{2};
  const Image before = drawn(scene, 0.0, kSide, pool), now = drawn(scene, 1.0, kSide, pool);
  const auto by_tolerance = [&](float tolerance) {
    return after_frames(scene, TemporalAa{{0.1f, HistoryBox::none}, 1, {tolerance, false}}, 2,
                        pool);
  };
  int uncovered = 0;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      uncovered += load_texel(before, x, y).w < 5.0f && load_texel(now, x, y).w > 5.0f;
    }
  }
  CHECK(uncovered > 50);
  CHECK(mean_square(by_tolerance(0.1f), now) < 1e-6);
  CHECK(mean_square(by_tolerance(0.0f), now) > 1e-2);
}

TEST_CASE("frames made of those before are nearer to the drawn one than the first of them is") {
  ThreadPool pool{2};
  const Scene scene = orbit_of_figures();
  constexpr int kFrames = 4;
  const Image truth = drawn(scene, kFrames - 1, kSide, pool);
  const double of_first = psnr(drawn(scene, 0.0, kSide, pool), truth);
  for (const FrameEffect& effect :
       {FrameEffect{Refresh{}}, FrameEffect{Reproject{kFrames, false, UnseenPixels::drawn}},
        FrameEffect{Reproject{kFrames, false, UnseenPixels::filled}},
        FrameEffect{Reproject{kFrames, true, UnseenPixels::drawn}},
        FrameEffect{Reproject{kFrames, true, UnseenPixels::filled}}}) {
    CHECK(psnr(after_frames(scene, effect, kFrames, pool), truth) > of_first + 3.0);
  }
}

TEST_CASE("a refresh draws its group and what was not seen, and says how much that is") {
  ThreadPool pool{2};
  const Scene scene = orbit_of_figures();
  PreparedScene prepared = prepare_scene(scene, {}, pool);
  FrameHistory history;
  draw_next(prepared, Refresh{4}, 0, kSide, kSide, history, pool);
  CHECK(history.shaded_share == 1.0);
  for (int i = 1; i < 6; ++i) {
    draw_next(prepared, Refresh{4}, i, kSide, kSide, history, pool);
    CHECK(history.shaded_share > 0.15);
    CHECK(history.shaded_share < 0.6);
  }
}

TEST_CASE("frames from those before have the same bits in any vectors and any number of threads" *
          doctest::test_suite("threads")) {
  const Scene scene = orbit_of_figures();
  ThreadPool alone{1, Isa::scalar};
  for (const FrameEffect& effect : {FrameEffect{TemporalAa{}}, FrameEffect{Refresh{}},
                                    FrameEffect{Reproject{3, true, UnseenPixels::filled}}}) {
    const Image expected = after_frames(scene, effect, 3, alone);
    for (const Isa isa : available_isas()) {
      ThreadPool pool{3, isa};
      CHECK(equal(after_frames(scene, effect, 3, pool), expected));
    }
  }
}

TEST_CASE("the passes of a frame can be run again and again, and make the frame") {
  ThreadPool pool{2};
  const Scene scene = orbit_of_figures();
  using enum UnseenPixels;
  for (const FrameEffect& effect :
       {FrameEffect{TemporalAa{}}, FrameEffect{Refresh{}}, FrameEffect{Reproject{.every = 3}},
        FrameEffect{Reproject{.every = 3, .holes = filled}},
        FrameEffect{Reproject{.every = 3, .holes = black}},
        FrameEffect{Reproject{.every = 3, .forward = true}},
        FrameEffect{Reproject{.every = 3, .forward = true, .holes = filled}}}) {
    PreparedScene prepared = prepare_scene(scene, {}, pool);
    FrameHistory history;
    for (int i = 0; i < 5; ++i) {
      CHECK(is_drawn_whole(effect, history) ==
            (i == 0 || (i == 3 && std::holds_alternative<Reproject>(effect))));
      draw_next(prepared, effect, i, kSide, kSide, history, pool);
    }
    FrameHistory drawn = history;
    draw_sources(prepared, effect, 5.0, kSide, kSide, drawn, pool);
    draw_next(prepared, effect, 5.0, kSide, kSide, history, pool);
    Image between = make_image(Format::rgba16f, kSide, kSide);
    Image frames = make_image(Format::r32f, kSide, kSide);
    for (int run = 0; run < 2; ++run) {
      Image picture = make_image(Format::rgba16f, kSide, kSide);
      make_frame(effect, sources_of(effect, drawn), {picture, frames, between}, {}, pool);
      CHECK(equal(picture, history.picture));
    }
  }
}

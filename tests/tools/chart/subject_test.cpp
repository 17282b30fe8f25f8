// Charts of other subjects than depth of field.

#include "tools/chart/subject.h"

#include <doctest/doctest.h>

#include <set>

#include "dof/halve.h"
#include "dof/measure/measures.h"
#include "tools/chart/contenders/runner.h"
#include "tools/chart/contenders/turn_contenders.h"
#include "tools/chart/options.h"
#include "tools/chart/point.h"
#include "tools/chart/record.h"
#include "tools/chart/scene.h"
#include "tools/cli/errors.h"

using namespace softfocus;

namespace {

ChartScene scene_of(const char* subject, const std::string& name, ThreadPool& pool,
                    PictureSize size = {64, 48}) {
  ChartOptions options;
  options.subject = find_chart_subject(subject);
  REQUIRE(options.subject != nullptr);
  options.size = size;
  return load_chart_scene(name, options, pool);
}

double flip_of(const Image& truth, const Image& picture, ThreadPool& pool) {
  return measure_pictures(truth, picture, nullptr, {}, pool).whole.flip;
}

Image truth_of(const ChartScene& scene, ThreadPool& pool) {
  return make_truth(
             scene, 256, [](int) {}, pool)
      .picture;
}

ChartEntry entry_of(const char* subject, const char* method, std::size_t setting) {
  return find_chart_subject(subject)->entries(method, 48, false).at(setting);
}

}  // namespace

TEST_CASE("chart subjects: each method has settings, and each setting a name of its own") {
  CHECK(chart_subjects().front().name == "depth-of-field");
  for (const ChartSubject& subject : chart_subjects()) {
    CAPTURE(subject.name);
    CHECK(subject.truth_samples % kTruthSampleStep == 0);
    CHECK(subject.quick_truth_samples % kTruthSampleStep == 0);
    const std::vector<std::string> names = subject.methods();
    CHECK(names.front() == kPinhole);
    std::set<std::string> ids;
    std::size_t entries = 0;
    for (const std::string& name : names) {
      for (const bool quick : {false, true}) CHECK(!subject.entries(name, 512, quick).empty());
      for (const ChartEntry& entry : subject.entries(name, 512, false)) {
        CHECK(entry.method == name);
        ids.insert(entry_id(entry));
        ++entries;
      }
    }
    CHECK(ids.size() == entries);
  }
  CHECK(find_chart_subject("fog") == nullptr);
}

TEST_CASE("chart of motion blur: the truth is many times of the scene's shutter, by a pinhole") {
  ThreadPool pool{2};
  const ChartScene scene = scene_of("motion-blur", "crossing", pool);
  LensViewInput input{.scene = scene.scene,
                      .camera = scene.view,
                      .frame = 0.0,
                      .pinhole = scene.pinhole,
                      .focus_m = scene.lens.focus_m,
                      .aperture_radius_m = 0.0,
                      .sampling = {.samples = 256, .until = 0.0, .shutter_frames = 0.5},
                      .profile = Profile{},
                      .progress = {}};
  CHECK(equal(truth_of(scene, pool), accumulation(input, pool).picture));
}

TEST_CASE("chart of motion blur: where nothing moves, the camera goes around; else it does not") {
  ThreadPool pool{1};
  CHECK(scene_of("motion-blur", "figures", pool).scene.camera.orbit_degrees_per_frame == 2.0);
  CHECK(scene_of("motion-blur", "random:3", pool).scene.camera.orbit_degrees_per_frame == 2.0);
  CHECK(scene_of("motion-blur", "windmill", pool).scene.camera.orbit_degrees_per_frame == 0.0);
  CHECK(scene_of("depth-of-field", "figures", pool).scene.camera.orbit_degrees_per_frame == 0.0);
}

TEST_CASE("chart of motion blur: more times are nearer to the truth, an instant is far") {
  ThreadPool pool{2};
  const ChartScene scene = scene_of("motion-blur", "windmill", pool);
  const Image truth = truth_of(scene, pool);
  ChartRunner runner{scene, pool};
  const auto error = [&](const ChartEntry& entry) {
    runner.run(entry);
    return flip_of(truth, runner.result(), pool);
  };
  const double instant = error(entry_of("motion-blur", "pinhole", 0));
  const double few = error(entry_of("motion-blur", "accumulation", 1));
  const double many = error(entry_of("motion-blur", "accumulation", 4));
  MESSAGE(instant << ", " << few << ", " << many);
  CHECK(few < instant);
  CHECK(many < 0.5 * few);
}

TEST_CASE("chart of motion blur: from one picture, each way is nearer than an instant" *
          doctest::test_suite("long")) {
  ThreadPool pool{2};
  const ChartScene scene = scene_of("motion-blur", "windmill", pool, {256, 256});
  const Image truth = truth_of(scene, pool);
  ChartRunner runner{scene, pool};
  const auto error = [&](const char* method) {
    const RunTime time = runner.run(entry_of("motion-blur", method, 1));
    CHECK(time.filter_ms.value() > 0.0);
    return flip_of(truth, runner.result(), pool);
  };
  runner.run(entry_of("motion-blur", "pinhole", 0));
  const double instant = flip_of(truth, runner.result(), pool);
  const double simple = error("motion-blur-simple"), by_tiles = error("motion-blur");
  MESSAGE(instant << ", " << simple << ", " << by_tiles);
  CHECK(simple < 0.8 * instant);
  CHECK(error("motion-blur-2012") < 0.8 * instant);
  CHECK(by_tiles < 0.9 * simple);
}

TEST_CASE("chart of anti-aliasing: what looks from more places in the pixel is nearer") {
  ThreadPool pool{2};
  const ChartScene scene = scene_of("anti-aliasing", "figures", pool);
  const Image truth = truth_of(scene, pool);
  ChartRunner runner{scene, pool};
  const auto error = [&](const ChartEntry& entry) {
    runner.run(entry);
    return flip_of(truth, runner.result(), pool);
  };
  const double none = error(entry_of("anti-aliasing", "pinhole", 0));
  const double twice = error(entry_of("anti-aliasing", "supersample", 0));
  const double sixteen = error(entry_of("anti-aliasing", "accumulation", 3));
  const double after_frames = error(entry_of("anti-aliasing", "temporal-aa", 2));
  MESSAGE(none << ", " << twice << ", " << sixteen << ", " << after_frames);
  CHECK(twice < 0.6 * none);
  CHECK(after_frames < 0.6 * none);
  CHECK(sixteen < twice);
}

TEST_CASE("chart of shadows: projected and volumes have no wrong pixel, maps have, a pinhole more" *
          doctest::test_suite("long")) {
  ThreadPool pool{2};
  const ChartScene scene = scene_of("shadows", "figures", pool, {96, 96});
  const Image truth = truth_of(scene, pool);
  ChartRunner runner{scene, pool};
  const auto wrong = [&](const char* method) {
    const ChartEntry entry = entry_of("shadows", method, 0);
    runner.run_warm(entry);
    return runner.wrong_pixels(entry);
  };
  const double without = wrong("pinhole");
  for (const char* method : {"projected", "projected-kept", "volumes", "volumes-z-pass"}) {
    CAPTURE(method);
    CHECK(wrong(method) == 0.0);
  }
  CHECK(wrong("by-rays") == 0.0);
  CHECK(equal(runner.result(), truth));
  CHECK_FALSE(equal(scene.pinhole, truth));
  for (const char* method : {"map", "map-kernel", "map-cascades", "map-kept"}) {
    CAPTURE(method);
    const double of_map = wrong(method);
    CHECK(of_map > 0.0);
    CHECK(of_map < 0.2 * without);
  }
}

TEST_CASE("chart of shadows: without a shadow all that a ray finds dark is wrong") {
  ThreadPool pool{2};
  const ChartScene scene = scene_of("shadows", "cube-room", pool);
  ChartRunner runner{scene, pool};
  const ChartEntry rays = entry_of("shadows", "by-rays", 0);
  const ChartEntry none = entry_of("shadows", "pinhole", 0);
  runner.run(none);
  const double first = runner.wrong_pixels(none);
  runner.run(rays);
  CHECK(runner.wrong_pixels(rays) == 0.0);
  CHECK(runner.wrong_pixels(none) == first);
  CHECK(first > 0.05 * 64 * 48);
}

TEST_CASE("chart of shadows: a scene without lights is refused by name") {
  ThreadPool pool{1};
  ChartScene scene = scene_of("shadows", "figures", pool);
  scene.scene.lights.clear();
  CHECK_THROWS_WITH_AS(truth_of(scene, pool),
                       "--scenes 'figures': has 0 lights; for shadows 1 to 8 would do", UsageError);
}

TEST_CASE(
    "chart of impostors: a redrawn turn is the truth, a tighter tolerance renews more often") {
  ThreadPool pool{2};
  const ChartScene scene = scene_of("impostors", "figures", pool, {128, 128});
  const Image truth = truth_of(scene, pool);
  CHECK(equal(scene.pinhole, truth));
  ChartRunner runner{scene, pool};
  const auto errors_of_turn = [&](const char* method, std::size_t setting) {
    ChartEntry entry = entry_of("impostors", method, setting);
    entry.turn->frames = 32;
    CHECK(runner.run_warm(entry).frame_ms > 0.0);
    ChartErrors errors;
    errors.flip = flip_of(truth, runner.result(), pool);
    runner.add_turn_errors(truth, errors);
    return errors;
  };
  const ChartErrors redrawn = errors_of_turn("pinhole", 0);
  CHECK(redrawn.flip == 0.0);
  CHECK(redrawn.outline_px == 0.0);
  CHECK(redrawn.renewals == 0.0);
  const ChartErrors tight = errors_of_turn("impostor-intertwined", 0);
  const ChartErrors loose = errors_of_turn("impostor-intertwined", 4);
  CHECK(loose.renewals >= 1.0);
  CHECK(tight.renewals > loose.renewals);
  CHECK(tight.flip < loose.flip);
  CHECK(tight.outline_px < 1.0);
  const ChartErrors marched = errors_of_turn("marched-bisection", 1);
  CHECK(marched.renewals > 0.0);
  CHECK(marched.megabytes < tight.megabytes);
  const ChartErrors atlas = errors_of_turn("octahedral", 0);
  CHECK(atlas.renewals == 0.0);
  CHECK(atlas.megabytes > 10.0 * tight.megabytes);
  CHECK(atlas.outline_px > tight.outline_px);
}

TEST_CASE("chart of impostors: a sheet that has no whole views is refused by its size") {
  ThreadPool pool{1};
  const ChartScene scene = scene_of("shadows", "figures", pool, {66, 64});
  CHECK_THROWS_WITH_AS(truth_of_turn(scene, pool),
                       "--size: a sheet of views has sides of 64 pixels or more, multiples of 4",
                       UsageError);
}

TEST_CASE("chart of shadows: what has fewer wrong pixels is better, whatever its FLIP") {
  ChartPanel panel;
  panel.ranked = kShadowErrors;
  const auto point = [&](const char* method, double ms, double wrong, double flip) {
    ChartPoint of{.entry = entry_of("shadows", method, 0)};
    of.errors.wrong_pixels = wrong;
    of.errors.flip = flip;
    of.times.frame_ms = {ms};
    panel.points.push_back(of);
  };
  point("pinhole", 1, 900, 0.1);
  point("map", 2, 40, 0.01);
  point("volumes", 3, 0, 0.02);
  point("map-kernel", 4, 50, 0.001);
  settle_points(panel);
  const std::vector<ChartPoint>& points = panel.points;
  CHECK(points[0].on_front);
  CHECK(points[1].on_front);
  CHECK(points[2].on_front);
  CHECK_FALSE(points[3].on_front);
}

TEST_CASE("chart runner: its pictures are those of what it times") {
  ThreadPool pool{2};
  const ChartScene scene = scene_of("anti-aliasing", "crossing", pool);
  ChartRunner runner{scene, pool};
  runner.run_warm(entry_of("anti-aliasing", "supersample", 0));
  const Image large = draw_scene(scene.scene, camera_matrices(scene.scene.camera, 0.0, 128, 96),
                                 0.0, 128, 96, Profile{}, pool);
  CHECK(equal(runner.result(), halve(large, Profile{}, pool)));
  const ChartEntry blurred = entry_of("anti-aliasing", "gaussian", 1);
  runner.run_warm(blurred);
  CHECK(equal(runner.result(),
              apply(*find_effect("gaussian"), {scene.pinhole, std::vector{0.6}, Profile{}}, pool)));
  for (const char* subject : {"anti-aliasing", "motion-blur"}) {
    const ChartScene of = scene_of(subject, "crossing", pool);
    ChartRunner views{of, pool};
    const ChartEntry entry = entry_of(subject, "accumulation", 2);
    views.run_warm(entry);
    CHECK(equal(views.result(), accumulation(accumulation_input(of, entry.samples), pool).picture));
  }
}

#include "scenes/relief/impostors/impostor_schedule.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "raster/images/texel.h"
#include "scenes/surfaces/surface_stages.h"
#include "tests/support/relief_scenes.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

constexpr int kSide = 64;

Scene ring_scene() { return test::orbited_torus(48, 3.0); }

struct TurnRecord {
  std::vector<ScheduledFrame> frames;
  std::vector<Image> pictures;
  int renewals = 0, stale = 0;
};

/// A part of a turn by a schedule. `frame_of` says where the eye is.
template <class FrameOf>
TurnRecord turn_by(const ImpostorSchedule& schedule, int frames, int threads, bool has_time,
                   const FrameOf& frame_of, double tolerance_texels = 1.6) {
  const Scene scene = ring_scene();
  ThreadPool pool(threads);
  ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  ImpostorSettings settings;
  settings.regions = 4;
  settings.tolerance_texels = tolerance_texels;
  ScheduledImpostor impostor = scheduled_impostor(schedule, pool.isa());
  TurnRecord record;
  for (int frame = 0; frame < frames; ++frame) {
    const CameraMatrices camera = camera_matrices(scene.camera, frame_of(frame), kSide, kSide);
    record.frames.push_back(update_scheduled(impostor, maker, settings, camera, scene.camera.up,
                                             kSide, pool, [&] { return has_time; }));
    Image picture = make_image(Format::rgba16f, kSide, kSide);
    clear_image(picture, {0.0f, 0.0f, 0.0f, 100.0f}, Profile{});
    draw_impostor(impostor.shown, camera, picture, pool);
    record.pictures.push_back(picture);
    record.renewals += record.frames.back().renewals;
    record.stale += record.frames.back().is_stale ? 1 : 0;
  }
  return record;
}

TurnRecord turn_by(const ImpostorSchedule& schedule, int frames, int threads = 2) {
  return turn_by(schedule, frames, threads, true, [](int frame) { return frame; });
}

}  // namespace

TEST_SUITE("threads") {
  TEST_CASE(
      "an update that takes so many frames gives the same pictures in slices and on a thread") {
    for (const bool warps_aside : {false, true}) {
      for (const bool predicts : {false, true}) {
        const TurnRecord sliced = turn_by({ScheduleKind::slices, warps_aside, 4, predicts}, 40, 1);
        const TurnRecord own = turn_by({ScheduleKind::own_thread, warps_aside, 4, predicts}, 40, 2);
        CAPTURE(warps_aside);
        CAPTURE(predicts);
        CHECK(sliced.renewals > 2);
        for (std::size_t i = 0; i < sliced.pictures.size(); ++i) {
          CHECK(equal(sliced.pictures[i], own.pictures[i]));
          CHECK(sliced.frames[i].takes == own.frames[i].takes);
          CHECK(sliced.frames[i].begins_for == own.frames[i].begins_for);
        }
      }
    }
  }

  TEST_CASE("an own thread without fixed slices ends what it began") {
    const TurnRecord own = turn_by({ScheduleKind::own_thread, true, 0, true}, 30, 2);
    int taken = 0;
    for (const ScheduledFrame& frame : own.frames) taken += frame.takes ? 1 : 0;
    CHECK(own.renewals > 0);
    CHECK(taken <= 30);
  }
}

TEST_CASE("a schedule in the frame makes an impostor's pictures") {
  const Scene scene = ring_scene();
  ThreadPool pool(2);
  ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  ImpostorSettings settings;
  settings.regions = 4;
  settings.tolerance_texels = 1.6;
  Impostor impostor;
  const TurnRecord record = turn_by({}, 30);
  for (int frame = 0; frame < 30; ++frame) {
    const CameraMatrices camera = camera_matrices(scene.camera, frame, kSide, kSide);
    const ImpostorStep step =
        update_impostor(impostor, maker, settings, camera, scene.camera.up, kSide, pool);
    Image picture = make_image(Format::rgba16f, kSide, kSide);
    clear_image(picture, {0.0f, 0.0f, 0.0f, 100.0f}, Profile{});
    draw_impostor(impostor, camera, picture, pool);
    CHECK(step == record.frames[static_cast<std::size_t>(frame)].step);
    CHECK(equal(picture, record.pictures[static_cast<std::size_t>(frame)]));
  }
}

TEST_CASE(
    "a renewal in fixed slices is shown so many frames after it began, and is late till then") {
  const TurnRecord record = turn_by({ScheduleKind::slices, false, 3, false}, 60);
  CHECK(record.frames[0].stalls);  // nothing was there
  int begun = -1, updates = 0;
  for (int i = 1; i < 60; ++i) {
    const ScheduledFrame& frame = record.frames[static_cast<std::size_t>(i)];
    CHECK(!frame.stalls);
    CHECK(frame.takes == (begun >= 0 && i == begun + 3));
    if (frame.takes) {
      CHECK(!frame.is_stale);
      begun = -1;
      ++updates;
    }
    if (frame.begins_for) begun = i;
    CHECK(frame.is_stale == (begun >= 0));
    CHECK(frame.late_frames == (begun >= 0 ? i - begun + 1 : 0));
    CHECK((frame.pieces > 0) == (begun >= 0));
  }
  CHECK(updates > 2);
}

TEST_CASE("with prediction no frame of an even turn is stale, and fewer renewals do") {
  const auto by = [](const ImpostorSchedule& schedule) {
    return turn_by(
        schedule, 160, 2, true, [](int frame) { return 0.5 * frame; }, 3.0);
  };
  const TurnRecord without = by({});
  const TurnRecord with = by({ScheduleKind::slices, false, 3, true});
  const TurnRecord in_frame = by({ScheduleKind::in_frame, false, 0, true});
  CHECK(without.stale == 0);
  CHECK(with.stale == 0);
  CHECK(with.renewals < without.renewals);
  CHECK(in_frame.stale == 0);
  CHECK(in_frame.renewals < without.renewals);
}

TEST_CASE("a warp in strips is the warp that a frame makes") {
  // The eye leaps, and stands.
  const auto leap = [](int frame) { return frame < 2 ? 0.0 : 5.0; };
  const TurnRecord whole = turn_by({}, 12, 2, true, leap);
  for (const int slices : {1, 3, 7}) {
    const TurnRecord strips =
        turn_by({ScheduleKind::slices, true, slices, false}, 12, 1, true, leap);
    CHECK(equal(strips.pictures[11], whole.pictures[11]));
    CHECK(strips.frames[static_cast<std::size_t>(2 + slices)].takes);
  }
  const TurnRecord variable = turn_by({ScheduleKind::slices, true, 0, false}, 12, 1, false, leap);
  CHECK(equal(variable.pictures[11], whole.pictures[11]));
}

TEST_CASE("a warp that is foreseen is for the eye of the frame that shows it") {
  const auto late_of = [](bool predicts) {
    const TurnRecord record = turn_by({ScheduleKind::slices, true, 4, predicts}, 40);
    int most = 0;
    // The first frame has no motion yet.
    for (std::size_t i = 8; i < 40; ++i) most = std::max(most, record.frames[i].late_frames);
    return most;
  };
  CHECK(late_of(false) == 7);  // begun 4 frames before, and shown for 4
  CHECK(late_of(true) == 3);
}

TEST_CASE("an eye that turns back makes no frame stale for longer than an update takes") {
  const TurnRecord record = turn_by({ScheduleKind::slices, false, 3, true}, 120, 2, true,
                                    [](int frame) { return frame < 50 ? frame : 100 - frame; });
  for (const ScheduledFrame& frame : record.frames) CHECK(frame.late_frames <= 4);
}

TEST_CASE("an eye that comes nearer is not foreseen so near that a relief has texels to waste") {
  Scene scene = ring_scene();
  scene.camera.orbit_degrees_per_frame = 0.0;
  const glm::dvec3 near = scene.camera.position;
  ThreadPool pool(2);
  ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  ScheduledImpostor impostor =
      scheduled_impostor({ScheduleKind::in_frame, false, 0, true}, pool.isa());
  int renewals = 0;
  for (int frame = 0; frame <= 60; ++frame) {
    scene.camera.position = near * (4.0 - 0.056 * frame);
    const CameraMatrices camera = camera_matrices(scene.camera, 0.0, kSide, kSide);
    const ScheduledFrame done = update_scheduled(impostor, maker, {}, camera, scene.camera.up,
                                                 kSide, pool, [] { return true; });
    renewals += done.renewals;
    CHECK(!done.is_stale);
    const ReliefForm now = impostor_form(maker, camera, {}, scene.camera.up, kSide);
    CHECK(impostor.shown.drawn->texture.height <= 1.6 * now.height);
  }
  CHECK(renewals <= 6);
}

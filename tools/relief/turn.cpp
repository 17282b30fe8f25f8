// softfocus relief turn: an object as a relief impostor through a full turn of the camera, beside
// the same frames redrawn.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "raster/images/texel.h"
#include "raster/numbers/half.h"
#include "raster/numbers/vector_math.h"
#include "scenes/relief/impostors/impostor_schedule.h"
#include "scenes/relief/impostors/octahedral_atlas.h"
#include "scenes/relief/impostors/relief_box.h"
#include "scenes/traced_relief/traced_relief.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/cli/timing.h"
#include "tools/relief/turn_frames.h"

namespace softfocus {
namespace {

/// Regions of the bound on the error, each way.
constexpr int kBoundRegions = 16;

CameraMatrices matrices_at(const TurnStage& stage, int frame) {
  const ReliefOptions& options = stage.options;
  if (options.approach == 0.0) return turned_camera(stage, frame);
  const double share = static_cast<double>(frame % options.frames) / (options.frames - 1);
  const double farther = options.approach + (1.0 - options.approach) * share;
  Camera camera = stage.camera;
  camera.position = camera.target + (camera.position - camera.target) * farther;
  return camera_matrices(camera, frame, options.size.width, options.size.height);
}

/// The scene's lights, turned about the object's middle against the eye.
void turn_lights(const Scene& scene, glm::dvec3 middle, double degrees,
                 std::vector<Light>& lights) {
  const glm::dvec3 up = normalize(scene.camera.up);
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const glm::dvec3 from{scene.lights[i].position_or_direction};
    lights[i].position_or_direction = glm::vec3{
        lights[i].kind == LightKind::point ? middle + turned_about(from - middle, up, degrees)
                                           : turned_about(from, up, degrees)};
  }
}

ImpostorSettings turn_settings(const ReliefOptions& options) {
  return {.warp = warp_rule(options),
          .projection = options.projection,
          .depth_bits = options.depth_bits,
          .tolerance_texels = options.tolerance,
          .regions = options.regions,
          .texels_per_pixel = options.texels_per_pixel,
          .sprites = !options.no_sprites && (!options.moving_light || options.lights_pixels),
          .lights_pixels = options.lights_pixels,
          .levels = options.levels,
          .cache_bytes = static_cast<std::size_t>(options.cache_mb * 1e6)};
}

ScheduleKind schedule_kind(TurnSchedule schedule) {
  return schedule == TurnSchedule::slices       ? ScheduleKind::slices
         : schedule == TurnSchedule::own_thread ? ScheduleKind::own_thread
                                                : ScheduleKind::in_frame;
}

// --- parts of RGBA16F pictures ---

/// A frame that is measured later: the part of it that is not blank.
struct KeptFrame {
  int frame;
  Rectangle area;
  std::vector<std::uint16_t> texels;
};

std::vector<std::uint16_t> part_of(const Image& picture, const Rectangle& area) {
  std::vector<std::uint16_t> texels;
  for (int y = area.y_begin; y < area.y_end; ++y) {
    const std::uint16_t* from = row<std::uint16_t>(picture, y).data();
    texels.insert(texels.end(), from + 4 * area.x_begin, from + 4 * area.x_end);
  }
  return texels;
}

Image whole_of(const KeptFrame& part, const Image& blank) {
  Image picture = blank;
  const std::uint16_t* from = part.texels.data();
  const int halves = 4 * (part.area.x_end - part.area.x_begin);
  for (int y = part.area.y_begin; y < part.area.y_end; ++y, from += halves) {
    std::copy_n(from, halves, row<std::uint16_t>(picture, y).data() + 4 * part.area.x_begin);
  }
  return picture;
}

// --- sums ---

struct TurnSums {
  std::vector<double> redrawn_ms, impostor_ms, renew_ms, recall_ms, warp_ms, sprite_ms;
  TurnErrors errors;
  std::vector<double> predicted, bound;  ///< divided by the largest error
  std::size_t most_bytes = 0;
  int renewals = 0, refreshes = 0, stalls = 0, stale = 0;
  std::vector<double> latency_frames;
};

/// Adds a frame's time and what was done in it.
void note_frame(const ScheduledFrame& frame, double ms, TurnSums& sums) {
  sums.impostor_ms.push_back(ms);
  (frame.step == ImpostorStep::renew    ? sums.renew_ms
   : frame.step == ImpostorStep::recall ? sums.recall_ms
   : frame.step == ImpostorStep::warp   ? sums.warp_ms
                                        : sums.sprite_ms)
      .push_back(ms);
  sums.renewals += frame.renewals;
  sums.refreshes += frame.takes ? 1 : 0;
  sums.stalls += frame.stalls ? 1 : 0;
  sums.stale += frame.is_stale ? 1 : 0;
  sums.latency_frames.push_back(frame.late_frames);
}

/// Least, median and largest.
Json ends_of(const std::vector<double>& values) {
  return {{"least", sorted_at(values, 0.0)},
          {"median", sorted_at(values, 0.5)},
          {"largest", sorted_at(values, 1.0)}};
}

/// The scene and the frames.
void add_scene(const TurnStage& stage, int frames, Findings& found) {
  found.add({{"scene", stage.scene.name},
             {"triangles", triangle_count(stage.scene)},
             {"frames", frames},
             {"size", size_text(stage.options.size)}});
}

/// What a frame's time is for.
std::string cause_of(const TurnSums& sums) {
  const auto total = [](const std::vector<double>& ms) {
    return std::accumulate(ms.begin(), ms.end(), 0.0);
  };
  const double renewing = total(sums.renew_ms), of_all = total(sums.impostor_ms);
  const std::string frames = " of " + std::to_string(sums.impostor_ms.size()) + " frames";
  if (renewing > of_all / 2.0) {
    return std::to_string(sums.renew_ms.size()) + frames + " draw and warp the relief anew, " +
           std::to_string(std::lround(100.0 * renewing / of_all)) + " % of the time";
  }
  return std::to_string(sums.warp_ms.size()) + frames + " warp the relief, " +
         std::to_string(std::lround(100.0 * total(sums.warp_ms) / of_all)) + " % of the time";
}

void add_sums(const TurnSums& sums, Findings& found) {
  const std::size_t frames = sums.impostor_ms.size();
  found.add({{"renewals", sums.renewals},
             {"recalls", sums.recall_ms.size()},
             {"warps", sums.warp_ms.size()},
             {"sprites", sums.sprite_ms.size()},
             {"most_megabytes", static_cast<double>(sums.most_bytes) / 1e6}},
            "steps");
  const double redrawn = mean_of(sums.redrawn_ms), impostor = mean_of(sums.impostor_ms);
  // The first frame has nothing to show before it has drawn.
  const std::vector<double> after_first(sums.impostor_ms.begin() + 1, sums.impostor_ms.end());
  found.add({{"redrawn", redrawn},
             {"impostor", impostor},
             {"ratio", redrawn / impostor},
             {"median_redrawn", sorted_at(sums.redrawn_ms, 0.5)},
             {"median_renew", sorted_at(sums.renew_ms, 0.5)},
             {"median_warp", sorted_at(sums.warp_ms, 0.5)},
             {"median_sprite", sorted_at(sums.sprite_ms, 0.5)},
             {"worst_after_first", sorted_at(after_first, 1.0)},
             {"below_in_99_of_100", sorted_at(after_first, 0.99)},
             {"worst_redrawn", sorted_at(sums.redrawn_ms, 1.0)}},
            "frame_ms");
  found.add(
      {{"frames_per_second", 1e3 / impostor},
       {"refreshes_per_second", 1e3 * sums.refreshes / (impostor * static_cast<double>(frames))},
       {"mean_latency_frames", mean_of(sums.latency_frames)},
       {"largest_latency_frames", sorted_at(sums.latency_frames, 1.0)},
       {"stale_frames", sums.stale},
       {"stalled_frames", sums.stalls}},
      "schedule");
  add_errors(sums.errors, found);
  found.add(ends_of(sums.predicted), "error_at_critical_point_by_largest");
  found.add(ends_of(sums.bound), "bound_by_largest");
}

// --- errors that are foreseen ---

struct ErrorShares {
  std::optional<CriticalRegions> bounds;
  std::optional<CriticalPoint> point;
};

void add_shares(const Impostor& impostor, glm::dvec3 eye, ErrorShares& shares, TurnSums& sums) {
  if (!impostor.drawn || !sees_front(impostor.drawn->texture, eye)) return;
  const ReliefTexture& relief = impostor.drawn->texture;
  if (!shares.bounds) {
    shares.bounds = critical_regions(relief, impostor.drawn->extent, kBoundRegions, kBoundRegions);
    shares.point = critical_point(relief);
  }
  if (!shares.point) return;
  const double largest = largest_error(relief, eye);
  sums.predicted.push_back(critical_error(relief, *shares.point, eye) / largest);
  sums.bound.push_back(error_bound(relief, *shares.bounds, eye) / largest);
}

std::size_t bytes_of_impostor(const ScheduledImpostor& impostor) {
  std::size_t bytes = impostor.shown.warped.colours.size() * (4 + 4);
  if (impostor.shown.drawn) bytes += bytes_of(*impostor.shown.drawn);
  for (const DrawnRelief& kept : impostor.shown.cache) bytes += bytes_of(kept);
  return bytes + impostor.spare_warp.colours.size() * (4 + 4);
}

}  // namespace

int turn_impostor(const ReliefOptions& options) {
  if (options.rival) return turn_octahedral(options);
  if (options.box) return turn_box(options);
  TurnStage stage{options};
  const Scene& scene = stage.scene;
  if (options.moving_light && scene.materials.size() > kMostReliefMaterials) {
    throw UsageError("--moving-light: '" + scene.name + "' has " +
                     std::to_string(scene.materials.size()) + " materials; at most " +
                     std::to_string(kMostReliefMaterials) + " are lit anew");
  }
  if (options.traced) {
    check_can_trace();
    stage.maker.trace = trace_relief;
  }
  // If the update has a thread of its own, the frames have one less.
  const bool has_own_thread = options.schedule == TurnSchedule::own_thread;
  ThreadPool frame_pool{options.schedule == TurnSchedule::serial ? 1
                        : has_own_thread ? std::max(options.pool.threads - 1, 1)
                                         : options.pool.threads,
                        options.pool.isa};
  std::vector<Light> lights = scene.lights;
  const ReliefLights laid = relief_lights(scene.ambient_light, lights);
  ImpostorSettings settings = turn_settings(options);
  if (options.moving_light) settings.lights = &laid;
  PixelLights pixel_lights{&laid};
  PixelLights* by_pixel = options.lights_pixels ? &pixel_lights : nullptr;
  const auto move_lights = [&](int frame) {
    if (!options.moving_light) return;
    turn_lights(scene, stage.maker.middle, -360.0 * frame / options.frames, lights);
  };
  ScheduledImpostor impostor = scheduled_impostor({.kind = schedule_kind(options.schedule),
                                                   .warps_aside = options.warps_aside,
                                                   .update_frames = options.update_frames,
                                                   .predicts = options.predicts},
                                                  options.pool.isa);
  TurnSums sums;
  const auto redrawn_ms = [&](int frame) {
    return milliseconds_of([&] { redraw(stage, matrices_at(stage, frame), lights); });
  };
  const auto is_measured = [&](int frame) { return frame % options.every == 0; };
  redrawn_ms(0);  // warms up
  Rectangle changed{0, 0, 0, 0};
  ErrorShares shares;
  std::vector<KeptFrame> kept;
  const int frames = options.turns * options.frames;
  for (int frame = 0; frame < frames; ++frame) {
    show_frame(stage, frame, frames);
    const CameraMatrices matrices = matrices_at(stage, frame);
    move_lights(frame);
    // An own thread must not get the time that redrawing takes: that comes after the turn.
    if (!has_own_thread) sums.redrawn_ms.push_back(redrawn_ms(frame));
    ScheduledFrame done{};
    const double ms = milliseconds_of([&] {
      // Clears the pixels that the frame before has drawn. The update's slice comes last, after the
      // frame could be shown.
      clear_area(stage.blank, changed, stage.shown, frame_pool);
      const auto end = std::chrono::steady_clock::now() +
                       std::chrono::duration<double, std::milli>(options.slice_ms);
      done = update_scheduled(impostor, stage.maker, settings, matrices, stage.camera.up,
                              options.size.height, frame_pool,
                              [&] { return std::chrono::steady_clock::now() < end; });
      changed = draw_impostor(impostor.shown, matrices, stage.shown, frame_pool, by_pixel);
    });
    note_frame(done, ms, sums);
    if (done.takes || done.renewals > 0 || done.step == ImpostorStep::recall) shares = {};
    sums.most_bytes = std::max(sums.most_bytes, bytes_of_impostor(impostor));
    if (!has_own_thread || is_measured(frame)) {
      add_shares(impostor.shown, matrices.eye, shares, sums);
    }
    if (!is_measured(frame)) continue;
    if (has_own_thread) {
      kept.push_back({frame, changed, part_of(stage.shown, changed)});
    } else {
      measure_frame(stage, frame, stage.shown, sums.errors);
    }
  }
  finish_update(impostor);
  stage.progress.clear();
  for (int frame = 0; has_own_thread && frame < frames; ++frame) {
    show_frame(stage, frame, frames);
    move_lights(frame);
    sums.redrawn_ms.push_back(redrawn_ms(frame));
    if (!is_measured(frame)) continue;
    const KeptFrame& part = kept[static_cast<std::size_t>(frame / options.every)];
    measure_frame(stage, frame, whole_of(part, stage.blank), sums.errors);
  }
  Findings found{options.json};
  add_verdict("impostor", mean_of(sums.impostor_ms), mean_of(sums.redrawn_ms), cause_of(sums),
              sums.errors, found);
  add_scene(stage, frames, found);
  found.add({{"turns", options.turns}, {"tolerance_texels", options.tolerance}});
  add_sums(sums, found);
  found.finish();
  return kDone;
}

// softfocus relief turn --box and --rival octahedral: the same turn by what was drawn once: six
// faces, or an octahedral impostor atlas.

namespace {

/// Lays something over the stage's blank picture, and returns the part that it may have changed.
using DrawTurned = std::function<Rectangle(const CameraMatrices&)>;

/// A turn of something that was drawn once, beside redrawing; finds times, named by `what`, and
/// errors. `measured` is called at each measured frame.
void turn_drawn_once(TurnStage& stage, const std::string& what, Findings& found,
                     const DrawTurned& draw,
                     const std::function<void(const CameraMatrices&)>& measured = {}) {
  TurnErrors errors;
  std::vector<double> redrawn_ms, shown_ms;
  Rectangle changed{0, 0, 0, 0};
  redraw(stage, turned_camera(stage, 0.0), stage.scene.lights);  // warms up
  for (int frame = 0; frame < stage.options.frames; ++frame) {
    show_frame(stage, frame, stage.options.frames);
    const CameraMatrices camera = turned_camera(stage, frame);
    redrawn_ms.push_back(milliseconds_of([&] { redraw(stage, camera, stage.scene.lights); }));
    shown_ms.push_back(milliseconds_of([&] {
      clear_area(stage.blank, changed, stage.shown, stage.pool);
      changed = draw(camera);
    }));
    if (frame % stage.options.every != 0) continue;
    measure_frame(stage, frame, stage.shown, errors);
    if (measured) measured(camera);
  }
  stage.progress.clear();
  const double redrawn_mean = mean_of(redrawn_ms), shown_mean = mean_of(shown_ms);
  add_verdict(what, shown_mean, redrawn_mean, "", errors, found);
  add_scene(stage, stage.options.frames, found);
  found.add({{"redrawn", redrawn_mean},
             {what.c_str(), shown_mean},
             {"ratio", redrawn_mean / shown_mean},
             {"median_redrawn", sorted_at(redrawn_ms, 0.5)},
             {("median_" + what).c_str(), sorted_at(shown_ms, 0.5)}},
            "frame_ms");
  add_errors(errors, found);
}

}  // namespace

int turn_box(const ReliefOptions& options) {
  TurnStage stage{options};
  const BoxForm form{std::max(options.texels.width, options.texels.height), options.depth_bits};
  ReliefBox box;
  const double made_ms =
      milliseconds_of([&] { box = draw_relief_box(stage.maker, form, stage.pool); });
  BoxMemory memory;
  std::size_t unseen = 0, unhad = 0, most_bytes = 0;
  Findings found{options.json};
  turn_drawn_once(
      stage, "box", found,
      [&](const CameraMatrices& camera) {
        draw_box(box, camera, box_rule(options), memory, stage.shown, stage.pool);
        return Rectangle{0, 0, options.size.width, options.size.height};
      },
      [&](const CameraMatrices& camera) {
        most_bytes = std::max(most_bytes, bytes_of(box) + bytes_of(memory));
        const float far_m = half_to_float(stage.background_depth);
        for (const FacePoint had : unseen_pixels(box, camera, stage.redrawn, far_m, stage.pool)) {
          unseen += had != FacePoint::by_seen ? 1 : 0;
          unhad += had == FacePoint::by_none ? 1 : 0;
        }
      });
  found.add({{"texels", form.texels},
             {"drawn_ms", made_ms},
             {"most_megabytes", static_cast<double>(most_bytes) / 1e6},
             {"pixels_that_no_seen_face_has", unseen},
             {"pixels_that_no_face_has", unhad}},
            "six_faces");
  found.finish();
  return kDone;
}

int turn_octahedral(const ReliefOptions& options) {
  TurnStage stage{options};
  const glm::dvec3 arm = stage.camera.position - stage.camera.target;
  const double distance = std::sqrt(dot(arm, arm)), radius_m = stage.maker.radius_m;
  // As sharp as an impostor's relief: a texel is a pixel, at the nearest point of the sphere.
  const double across = options.texels_per_pixel *
                        pixels_across(options.size.height, 2.0 * radius_m, distance - radius_m,
                                      1.0 / std::fabs(turned_camera(stage, 0.0).eye_to_clip[1][1]));
  const int texels = std::clamp(static_cast<int>(std::ceil(std::fmin(across, kMostReliefSize))) + 2,
                                4, kMostReliefSize);
  const OctahedralForm form{.views = options.views,
                            .hemisphere = options.hemisphere,
                            .texels = texels,
                            .depth_bits = options.depth_bits,
                            .with_normals = false,
                            .distance_m = distance};
  std::optional<OctahedralAtlas> atlas;
  const double made_ms =
      milliseconds_of([&] { atlas = make_octahedral_atlas(stage.maker, form, stage.pool); });
  const int width = options.size.width, height = options.size.height;
  Findings found{options.json};
  turn_drawn_once(stage, "atlas", found, [&](const CameraMatrices& camera) {
    draw_octahedral(*atlas, camera, options.parallax, stage.shown, stage.pool);
    return octahedral_area(*atlas, camera, width, height);
  });
  found.add({{"views", size_text({options.views, options.views})},
             {"of", options.hemisphere ? "hemisphere" : "sphere"},
             {"texels", size_text({texels, texels})},
             {"parallax", options.parallax},
             {"megabytes", static_cast<double>(bytes_of(*atlas)) / 1e6},
             {"drawn_ms", made_ms}},
            "octahedral_atlas");
  found.finish();
  return kDone;
}

}  // namespace softfocus

#include "tools/relief/turn_frames.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "dof/measure/measures.h"
#include "dof/measure/regions.h"
#include "raster/images/texel.h"
#include "raster/numbers/half.h"
#include "raster/numbers/vector_math.h"
#include "scenes/surfaces/surface_stages.h"
#include "tools/cli/errors.h"
#include "tools/cli/timing.h"
#include "tools/files/whole_file.h"

namespace softfocus {

namespace {

Camera turn_camera(const Scene& scene, const ReliefMaker& maker, const ReliefOptions& options) {
  Camera camera = scene.camera;
  const glm::dvec3 arm = camera.position - camera.target;
  const double zoomed = 1.0 / options.zoom;
  camera.position_keys = camera.target_keys = {};
  camera.target = maker.middle;
  camera.position = maker.middle + arm * zoomed;
  const double distance = std::sqrt(dot(arm, arm)) * zoomed;
  if (distance <= 1.2 * maker.radius_m) {
    throw UsageError("--zoom: the eye would come into the object's box; a smaller one is right");
  }
  camera.near_m = (distance - maker.radius_m) * 0.5;
  camera.far_m = distance * 10.0 * std::fmax(options.approach, 1.0);
  camera.orbit_degrees_per_frame = options.approach > 0.0 ? 0.0 : 360.0 / options.frames;
  return camera;
}

}  // namespace

std::optional<NumberedName> frame_names(const ReliefOptions& options, FileFormat& format) {
  if (options.output.empty()) return std::nullopt;
  std::optional<NumberedName> name = numbered_name("-o", options.output);
  const auto by_name = format_by_extension(options.output);
  if (!name || !by_name) {
    throw UsageError("-o '" + options.output + "': a " + options.action +
                     " has many frames; a name such as " + options.action +
                     "_%04d.png would be right");
  }
  check_writable(name_at(*name, 0));
  format = *by_name;
  return name;
}

void write_pair(const Image& left, const Image& right, const std::filesystem::path& file,
                FileFormat format) {
  Image pair = make_image(Format::rgba16f, 2 * left.width, left.height);
  for (int y = 0; y < pair.height; ++y) {
    std::uint16_t* to = row<std::uint16_t>(pair, y).data();
    const auto from_left = row<std::uint16_t>(left, y), from_right = row<std::uint16_t>(right, y);
    std::copy(from_left.begin(), from_left.end(), to);
    std::copy(from_right.begin(), from_right.end(), to + from_left.size());
  }
  WholeFile whole{file};
  whole.write(encode(pair, format));
  whole.commit();
}

glm::vec4 turn_background(const Scene& scene, const Camera& camera) {
  const glm::vec4 background = clear_colour(scene);
  return {glm::vec3{background}, alpha_depth(static_cast<float>(camera.far_m))};
}

TurnStage::TurnStage(const ReliefOptions& told)
    : options(told),
      name(frame_names(told, format)),
      scene(relief_scene(told)),
      pool(told.pool.threads, told.pool.isa),
      maker(prepare_relief(scene, told.frame, pool)),
      prepared(prepare_scene(scene, Profile{}, pool)),
      camera(turn_camera(scene, maker, told)),
      clear(turn_background(scene, camera)),
      background_depth(float_to_half(clear.w, HalfRounding::nearest_even)),
      redrawn(make_image(Format::rgba16f, told.size.width, told.size.height)),
      shown(redrawn) {
  clear_image(shown, clear, Profile{});
  blank = shown;
  prepared.depth = make_image(Format::r32f, told.size.width, told.size.height);
}

CameraMatrices turned_camera(const TurnStage& stage, double frame) {
  return camera_matrices(stage.camera, frame, stage.shown.width, stage.shown.height);
}

void redraw(TurnStage& stage, const CameraMatrices& camera, std::span<const Light> lights) {
  RenderPass& pass = stage.prepared.pass;
  pass.targets.colour[0] = &stage.redrawn;
  pass.targets.depth = &stage.prepared.depth;
  record_scene(stage.prepared, camera, stage.options.frame, pass, lights);
  pass.clear_colour = stage.clear;
  finish(pass, stage.pool);
}

void clear_area(const Image& blank, const Rectangle& area, Image& to, ThreadPool& pool) {
  constexpr int kRows = 16;
  const int rows = area.y_end - area.y_begin;
  const std::uint16_t* texels = row<std::uint16_t>(blank, 0).data() + 4 * area.x_begin;
  pool.for_each((rows + kRows - 1) / kRows, [&](int band) {
    const int begin = area.y_begin + kRows * band;
    for (int y = begin; y < std::min(begin + kRows, area.y_end); ++y) {
      std::copy_n(texels, 4 * (area.x_end - area.x_begin),
                  row<std::uint16_t>(to, y).data() + 4 * area.x_begin);
    }
  });
}

void measure_frame(TurnStage& stage, int frame, const Image& shown, TurnErrors& errors) {
  const Image& redrawn = stage.redrawn;
  const std::vector<std::uint8_t> drawn = coverage_of(redrawn, stage.background_depth);
  const OutlineError outline = outline_error(drawn, coverage_of(shown, stage.background_depth),
                                             redrawn.width, redrawn.height);
  errors.outline_px.push_back(outline.mean_px);
  errors.most_outline_px = std::fmax(errors.most_outline_px, outline.most_px);
  errors.lost += outline.lost;
  errors.gained += outline.gained;
  errors.seen += outline.seen;
  const MeasuredPictures measured = measure_pictures(redrawn, shown, nullptr, {}, stage.pool);
  errors.flip.push_back(measured.whole.flip);
  // All of FLIP lies on the object and around it.
  const auto pixels = static_cast<double>(drawn.size());
  errors.object_flip.push_back(
      outline.seen == 0 ? 0.0 : measured.whole.flip * pixels / static_cast<double>(outline.seen));
  if (stage.name) write_pair(redrawn, shown, name_at(*stage.name, frame), stage.format);
}

void show_frame(TurnStage& stage, int frame, int frames) {
  constexpr double kEverySeconds = 0.5;
  if (frame == 0) {
    stage.left.plan("frames", frames, 1.0);
    stage.left.start();
  } else {
    stage.left.done("frames", 1.0);
  }
  const auto now = std::chrono::steady_clock::now();
  if (std::chrono::duration<double>(now - stage.shown_at).count() < kEverySeconds) return;
  stage.shown_at = now;
  const double seconds = stage.left.seconds();
  stage.progress.show("frame " + std::to_string(frame + 1) + " of " + std::to_string(frames) +
                      (seconds > 0.0 ? "; " + time_left_text(seconds) : ""));
}

void add_verdict(const std::string& what, double shown_ms, double redrawn_ms,
                 const std::string& why, const TurnErrors& errors, Findings& found) {
  const auto number = [](double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.3g", value);
    return std::string{text.data()};
  };
  const bool pays = shown_ms < redrawn_ms;
  std::string text = pays ? "pays: " : "does not pay: ";
  text += number(shown_ms) + " ms a frame, redrawn " + number(redrawn_ms) + " ms (" +
          number(pays ? redrawn_ms / shown_ms : shown_ms / redrawn_ms) +
          (pays ? " times as fast)" : " times as slow)");
  if (!why.empty()) text += ", for " + why;
  text += "; the object's FLIP error is " + number(mean_of(errors.object_flip)) +
          ", its outline is off by " + number(mean_of(errors.outline_px)) + " pixels";
  found.add({{what.c_str(), text}}, "verdict");
}

void add_errors(const TurnErrors& errors, Findings& found) {
  found.add({{"flip", mean_of(errors.flip)},
             {"most_flip", sorted_at(errors.flip, 1.0)},
             {"object_flip", mean_of(errors.object_flip)},
             {"outline_px", mean_of(errors.outline_px)},
             {"most_mean_outline_px", sorted_at(errors.outline_px, 1.0)},
             {"most_outline_px", errors.most_outline_px},
             {"seen_pixels", errors.seen},
             {"lost_pixels", errors.lost},
             {"gained_pixels", errors.gained}},
            "errors");
}

}  // namespace softfocus

// softfocus relief walk: a scene's camera goes its way, with impostors and without.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include "dof/measure/measures.h"
#include "raster/images/texel.h"
#include "raster/numbers/srgb.h"
#include "scenes/load/load_scene.h"
#include "scenes/relief/impostors/scene_impostors.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/cli/progress.h"
#include "tools/cli/timing.h"
#include "tools/files/findings.h"
#include "tools/options/run_options.h"
#include "tools/relief/relief_options.h"
#include "tools/relief/turn_frames.h"

namespace softfocus {
namespace {

constexpr int kJumpBlock = 16;

/// Of a pixel's three channels in the sRGB curve, as drawn less as it should be.
using Errors = std::vector<std::array<int, 3>>;

Errors errors_of(const Image& shown, const Image& redrawn, ThreadPool& pool) {
  const auto width = static_cast<std::size_t>(shown.width);
  Errors errors(width * static_cast<std::size_t>(shown.height));
  pool.for_each(shown.height, [&](int y) {
    for (int x = 0; x < shown.width; ++x) {
      const glm::vec4 a = load_texel<Format::rgba16f>(shown, x, y);
      const glm::vec4 b = load_texel<Format::rgba16f>(redrawn, x, y);
      auto& to = errors[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)];
      for (int c = 0; c < 3; ++c) {
        to[static_cast<std::size_t>(c)] = int{linear_to_srgb8(a[c])} - int{linear_to_srgb8(b[c])};
      }
    }
  });
  return errors;
}

/// The mean difference of the block of kJumpBlock x kJumpBlock pixels that has the largest, 0 to 1.
double largest_jump(const Errors& a, const Errors& b, int width, int height) {
  double largest = 0.0;
  for (int top = 0; top + kJumpBlock <= height; top += kJumpBlock) {
    for (int left = 0; left + kJumpBlock <= width; left += kJumpBlock) {
      int sum = 0;
      for (int y = top; y < top + kJumpBlock; ++y) {
        for (int x = left; x < left + kJumpBlock; ++x) {
          const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                                 static_cast<std::size_t>(x);
          for (std::size_t c = 0; c < 3; ++c) sum += std::abs(a[at][c] - b[at][c]);
        }
      }
      largest = std::max(largest, sum / (3.0 * 255.0 * kJumpBlock * kJumpBlock));
    }
  }
  return largest;
}

/// What the curve has of each frame; negative where it was not measured.
struct WalkFrame {
  int frame;
  double ms;
  ImpostorCounts counts;
  double redrawn_ms = -1.0, flip = -1.0, jump = -1.0, own_change = -1.0;
};

void add_curve(const std::vector<WalkFrame>& frames, Findings& found) {
  found.begin_table("curve", {});
  for (const WalkFrame& frame : frames) {
    Json point{{"frame", frame.frame},
               {"ms", frame.ms},
               {"shown", frame.counts.shown},
               {"renewed", frame.counts.renewed},
               {"as_geometry", frame.counts.as_geometry},
               {"out_of_view", frame.counts.out_of_view},
               {"predicted_ms", frame.counts.predicted_ms},
               {"triangles", frame.counts.triangles},
               {"texels", frame.counts.texels},
               {"renewed_triangles", frame.counts.renewed_triangles},
               {"renewed_texels", frame.counts.renewed_texels},
               {"megabytes", static_cast<double>(frame.counts.bytes) / 1e6}};
    if (frame.flip >= 0.0) {
      point["redrawn_ms"] = frame.redrawn_ms;
      point["flip"] = frame.flip;
    }
    if (frame.jump >= 0.0) {
      point["jump"] = frame.jump;
      point["own_change"] = frame.own_change;
    }
    found.add_row(point);
  }
}

/// Tenths of the walk.
void add_tenths(const std::vector<WalkFrame>& frames, Findings& found) {
  found.begin_table("tenths", {{"from_frame", 10},
                               {"ms", 8, 2},
                               {"redrawn_ms", 10, 1},
                               {"renewals", 8},
                               {"as_geometry", 11, 1},
                               {"megabytes", 9, 1},
                               {"flip", 7, 4},
                               {"jump", 7, 4}});
  const std::size_t parts = std::min<std::size_t>(10, frames.size());
  for (std::size_t part = 0; part < parts; ++part) {
    const std::size_t begin = frames.size() * part / parts;
    const std::size_t end = frames.size() * (part + 1) / parts;
    std::vector<double> ms, redrawn, flip, jump, geometry, bytes;
    int renewals = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const WalkFrame& frame = frames[i];
      ms.push_back(frame.ms);
      geometry.push_back(frame.counts.as_geometry);
      bytes.push_back(static_cast<double>(frame.counts.bytes) / 1e6);
      renewals += frame.counts.renewed;
      if (frame.flip >= 0.0) {
        redrawn.push_back(frame.redrawn_ms);
        flip.push_back(frame.flip);
      }
      if (frame.jump >= 0.0) jump.push_back(frame.jump);
    }
    found.add_row({{"from_frame", frames[begin].frame},
                   {"ms", mean_of(ms)},
                   {"redrawn_ms", mean_of(redrawn)},
                   {"renewals", renewals},
                   {"as_geometry", mean_of(geometry)},
                   {"megabytes", sorted_at(bytes, 1.0)},
                   {"flip", mean_of(flip)},
                   {"jump", sorted_at(jump, 1.0)}});
  }
}

std::vector<double> values_of(const std::vector<WalkFrame>& frames, double WalkFrame::*member) {
  std::vector<double> values;
  for (const WalkFrame& frame : frames) {
    if (frame.*member >= 0.0) values.push_back(frame.*member);
  }
  return values;
}

}  // namespace

int walk_scene(const ReliefOptions& options) {
  ThreadPool pool{options.pool.threads, options.pool.isa};
  FileFormat format = options.format;
  const std::optional<NumberedName> name = frame_names(options, format);
  Scene scene = load_scene(options.input, scene_search_path(options.scene_path), &pool);
  print_scene_warnings(scene.warnings, false);
  if (!has_impostors(scene)) {
    warn("no object of '" + scene.name + "' is an impostor: all are, where that costs less");
    for (Object& object : scene.objects) object.impostor = ImpostorUse::where_cheaper;
  }
  const auto [width, height] = options.size;
  PreparedScene as_geometry = prepare_scene(scene, Profile{}, pool);
  PreparedScene prepared = prepare_scene(scene, Profile{}, pool);
  const std::shared_ptr<SceneImpostors> impostors = make_scene_impostors(scene, pool);
  prepared.stand_ins = stand_ins_of(impostors);
  Image shown = make_image(Format::rgba16f, width, height), redrawn = shown;
  Progress progress;
  std::vector<WalkFrame> frames;
  Errors before;
  Image redrawn_before;
  for (int number = 0; number < options.frames; ++number) {
    progress.show("frame " + std::to_string(number + 1) + " of " + std::to_string(options.frames));
    const double at = options.frame + number;
    const CameraMatrices camera = camera_matrices(scene.camera, at, width, height);
    WalkFrame frame{number, 0.0, {}};
    frame.ms = milliseconds_of([&] { draw_scene(prepared, camera, at, shown, pool); });
    frame.counts = impostors->counts;
    const bool is_measured = number % options.every == 0;
    if (is_measured || number % options.every == 1) {
      frame.redrawn_ms =
          milliseconds_of([&] { draw_scene(as_geometry, camera, at, redrawn, pool); });
      Errors errors = errors_of(shown, redrawn, pool);
      if (!before.empty()) {
        const Errors own = errors_of(redrawn, redrawn_before, pool);
        frame.jump = largest_jump(errors, before, width, height);
        frame.own_change = largest_jump(own, Errors(own.size()), width, height);
      }
      frame.flip = measure_pictures(redrawn, shown, nullptr, {}, pool).whole.flip;
      before = std::move(errors);
      redrawn_before = redrawn;
      if (name && is_measured) write_pair(redrawn, shown, name_at(*name, number), format);
    } else {
      before.clear();
    }
    frames.push_back(frame);
  }
  progress.clear();
  // The first frame draws all reliefs.
  std::vector<double> ms, redrawn_ms = values_of(frames, &WalkFrame::redrawn_ms);
  std::size_t most_bytes = 0;
  int renewals = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (i > 0) ms.push_back(frames[i].ms);
    if (i > 0) renewals += frames[i].counts.renewed;
    most_bytes = std::max(most_bytes, frames[i].counts.bytes);
  }
  const std::vector<double> flip = values_of(frames, &WalkFrame::flip);
  const std::vector<double> jumps = values_of(frames, &WalkFrame::jump);
  Findings found{options.json};
  found.add({{"scene", scene.name},
             {"triangles", triangle_count(scene)},
             {"frames", options.frames},
             {"size", size_text(options.size)},
             {"tolerance_px", scene.impostors.tolerance_px}});
  found.add({{"mean", mean_of(ms)},
             {"median", sorted_at(ms, 0.5)},
             {"below_in_99_of_100", sorted_at(ms, 0.99)},
             {"worst_after_first", sorted_at(ms, 1.0)},
             {"first", frames.front().ms},
             {"redrawn", mean_of(redrawn_ms)},
             {"ratio", mean_of(redrawn_ms) / mean_of(ms)}},
            "frame_ms");
  found.add({{"impostors", 1e3 / mean_of(ms)}, {"geometry", 1e3 / mean_of(redrawn_ms)}},
            "frames_per_second");
  found.add({{"renewals", renewals},
             {"most_megabytes", static_cast<double>(most_bytes) / 1e6},
             {"flip", mean_of(flip)},
             {"most_flip", sorted_at(flip, 1.0)},
             {"median_jump", sorted_at(jumps, 0.5)},
             {"largest_jump", sorted_at(jumps, 1.0)},
             {"own_change", mean_of(values_of(frames, &WalkFrame::own_change))}},
            "impostors");
  add_tenths(frames, found);
  if (options.json) add_curve(frames, found);
  found.finish();
  return kDone;
}

}  // namespace softfocus

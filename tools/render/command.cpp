// softfocus render: the way of a frame from a scene's file to a picture's.

#include <array>
#include <chrono>
#include <deque>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "raster/threads/background.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/draw/light_points.h"
#include "scenes/draw/shadowed_layers.h"
#include "scenes/draw/transparent_layers.h"
#include "scenes/frame/frame.h"
#include "scenes/frame/frame_rows.h"
#include "scenes/load/load_scene.h"
#include "scenes/relief/impostors/scene_impostors.h"
#include "scenes/scene.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/cli/progress.h"
#include "tools/files/whole_file.h"
#include "tools/gl/frame_on_gl.h"
#include "tools/options/run_options.h"
#include "tools/render/options.h"
#include "tools/render/performance_report.h"
#include "tools/render/picture_files.h"
#include "tools/render/render_by_rows.h"
#include "tools/render/render_frames.h"
#include "tools/render/shard_file.h"

namespace softfocus {
namespace {

/// --until's error was not reached.
std::string until_warning(const RenderRecord& record) {
  const Sampling& sampling = record.frame.sampling;
  if (!record.frame.sampled || !sampling.until) return {};
  const auto reached = record.frame.sampled->half_set_rms;
  if (reached && *reached <= *sampling.until) return {};
  const std::string found = reached ? "the half-sets differ by " + short_number(*reached)
                                    : "half-sets are compared from 16 samples on";
  return "--until " + short_number(*sampling.until) + ": not reached with " +
         count_text(record.frame.sampled->samples, "sample") + ": " + found;
}

/// auto predicts or measures that it misses its goal.
std::string goal_warning(const RenderOptions& options, const RenderRecord& record) {
  if (!record.frame.chosen || record.frame.chosen->choice.meets_goal) return {};
  const AutoMethod& choice = record.frame.chosen->choice;
  if (record.frame.chosen->measured_error) {
    return "--max-error " + short_number(options.goal.max_error) + ": not kept to; " +
           setting_text(choice) + " shows an error of " +
           short_number(*record.frame.chosen->measured_error);
  }
  return "--max-error " + short_number(options.goal.max_error) +
         ": no method is predicted to keep to it; " + setting_text(choice) +
         " comes nearest, with a predicted error of " + short_number(choice.predicted_error);
}

/// How the picture of a scene with transparent surfaces falls short.
std::string transparent_warning(const Scene& scene, const FrameParts& parts,
                                const RenderOptions& options) {
  if (!has_transparent(scene)) return {};
  const bool filters = options.show == Show::image && options.method.filter != nullptr;
  if (options.show == Show::image && options.method.name() == "surface-splatting") {
    return "--method surface-splatting: surfaces of opacity 1/2 or more are drawn opaque, other "
           "transparent ones not at all";
  }
  if (filters && options.method.name() != "pinhole" &&
      (options.gl != nullptr || options.arithmetic != Arithmetic::floats ||
       !options.sharp_depths.empty())) {
    return std::string{options.gl != nullptr                      ? "--gl"
                       : options.arithmetic != Arithmetic::floats ? "--arithmetic"
                                                                  : "--sharp-depths"} +
           ": a transparent surface and what is seen through it are blurred by one circle";
  }
  if (parts.transparent.size() < kTransparentLayers) return {};
  return "there are pixels of " + std::to_string(kTransparentLayers) +
         " transparent surfaces; if there are more behind them, those are left out";
}

/// Does a stage's work, with its name on the terminal and its time noted.
template <class Work>
auto timed(Progress& progress, const char* stage, double& ms, Work work) {
  progress.show(stage);
  struct Stopwatch {
    double& ms;
    std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
    ~Stopwatch() {
      const auto end = std::chrono::steady_clock::now();
      ms = std::chrono::duration<double, std::milli>(end - start).count();
    }
  } const stopwatch{ms};
  return work();
}

/// The field that a stage's time goes to.
double& time_of(FrameStage stage, StageTimes& ms) {
  switch (stage) {
    case FrameStage::drawing: return ms.draw;
    case FrameStage::focusing: return ms.focus;
    case FrameStage::choosing: return ms.choose;
    case FrameStage::checking: return ms.check;
    default: return ms.filter;
  }
}

/// Names the stages of the frame maker on the terminal and notes their times.
class StageWatch {
 public:
  StageWatch(Progress& progress, StageTimes& ms) : progress_(progress), ms_(ms) {}

  void begin(FrameStage stage) {
    stop();
    static constexpr std::array kNames{"drawing",  "focusing", "choosing", "filtering", "sampling",
                                       "checking", "halving",  "effects",  ""};
    progress_.show(kNames[static_cast<std::size_t>(stage)]);
    if (stage != FrameStage::done) timed_ = &time_of(stage, ms_);
    begun_ = Clock::now();
  }
  void stop() {
    if (timed_ == nullptr) return;
    *timed_ += std::chrono::duration<double, std::milli>(Clock::now() - begun_).count();
    timed_ = nullptr;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Progress& progress_;
  StageTimes& ms_;
  double* timed_ = nullptr;
  Clock::time_point begun_{};
};

std::string samples_text(const Shot& shot) {
  const Sampling& sampling = shot.sampling;
  const SampleRange range = samples_of(shot.shard.value_or(Shard{}), sampling.samples);
  return std::string{" of "} + (sampling.until || sampling.by_tile ? "at most " : "") +
         std::to_string(range.end - range.begin);
}

/// --gl: a driver draws and filters.
void put_on_gl(FrameOnGl& on_gl, const Shot& shot, FrameHooks& hooks) {
  hooks.draw = [&](const CameraMatrices& view, int width, int height, std::size_t layers) {
    FrameParts drawn;
    if (layers == 1) {
      drawn.opaque = on_gl.draw(*shot.scene, view, shot.frame, width, height);
      return drawn;
    }
    drawn.behind = on_gl.draw_layers(*shot.scene, view, shot.frame, width, height, layers);
    drawn.opaque = std::move(drawn.behind.front());
    drawn.behind.erase(drawn.behind.begin());
    return drawn;
  };
  hooks.filter = [&](const Method& method, const DofSettings& settings, const Image& picture) {
    return on_gl.filter(method, settings, picture);
  };
}

/// Makes the frame, and notes its times and what is to be said of what was drawn.
Frame watched_frame(const Shot& shot, const RenderOptions& options, RenderRecord& record,
                    std::vector<std::string>& warnings, Progress& progress, ThreadPool& pool) {
  StageWatch watch{progress, record.ms};
  FrameHooks hooks;
  hooks.on_stage = [&](FrameStage stage) { watch.begin(stage); };
  hooks.on_light_points = [&progress, points = shot.scene->light_points](int point) {
    progress.show("drawing, " + std::to_string(point) + " of " + std::to_string(points) +
                  " points of the lights");
  };
  if (!shot.method.is_auto()) {
    hooks.on_samples = [&progress, of_all = samples_text(shot)](int samples) {
      progress.show("sampling the lens, " + std::to_string(samples) + of_all);
    };
  }
  hooks.on_drawn = [&](const DrawnFrame& drawn, const std::optional<UsedLens>& lens) {
    watch.stop();
    if (lens && cuts_by_default(options)) {
      warnings.push_back(
          cut_warning(cut_circles(drawn.parts.picture(), *lens, pool), options, *lens));
    }
    warnings.push_back(transparent_warning(*shot.scene, drawn.parts, options));
  };
  std::optional<FrameOnGl> on_gl;
  if (options.gl != nullptr) {
    record.gl_renderer = on_gl.emplace(*options.gl, options.shaders).renderer();
    put_on_gl(*on_gl, shot, hooks);
  }
  try {
    return make_frame(shot, pool, hooks);
  } catch (const LensError& error) {
    refuse_lens(error, options);
  }
}

/// What is said once the files are there.
struct Rendered {
  Bytes picture{};  ///< of -o -
  std::vector<std::string> warnings{};
  std::string report{}, json{};
};

/// The picture's file, and the record's hash. Each byte of a hash waits for the one before: on a
/// second thread it costs no time.
Bytes encoded_beside_hash(const RenderOptions& options, RenderRecord& record, ThreadPool& pool) {
  const Image& picture = record.frame.picture;
  const PictureExtras extras{.pool = &pool};
  if (pool.threads() == 1) {
    record.picture_hash = hash_image(picture);
    return encode_with_notes(picture, options.format, notes_of(options, record), extras);
  }
  std::uint64_t hash = 0;
  Background beside;
  beside.begin([&] { hash = hash_image(picture); });
  const auto hash_when_there = [&] {
    beside.wait();
    return hash;
  };
  Bytes bytes = encode_with_notes(picture, options.format, notes_of(options, record), extras,
                                  hash_when_there);
  record.picture_hash = hash_when_there();
  return bytes;
}

/// Writes what was asked for of the frame. The files get their names together, when nothing can
/// fail but the naming.
Rendered write_frame(const RenderOptions& options, RenderRecord& record,
                     std::vector<std::string> warnings, Progress& progress, ThreadPool& pool) {
  std::deque<WholeFile> files;
  const auto write = [&](const std::filesystem::path& place, const auto& bytes) {
    files.emplace_back(place).write(bytes);
  };
  const Image& picture = record.frame.picture;
  auto sidecar = sidecar_place(options);
  if (sidecar && !is_free_for_sidecar(*sidecar)) {
    warnings.push_back(busy_sidecar_warning(*sidecar));
    sidecar.reset();
  }
  Rendered made;
  made.picture = timed(progress, "encoding", record.ms.encode,
                       [&] { return encoded_beside_hash(options, record, pool); });
  const PictureNotes notes = notes_of(options, record);
  timed(progress, "writing", record.ms.write, [&] {
    if (options.output != "-") write(options.output, made.picture);
    for (std::size_t i = 0; i < record.frame.behind.size(); ++i) {
      write(layer_place(options, i + 2),
            encode_with_notes(record.frame.behind[i], options.format, notes, {.pool = &pool}));
    }
    if (sidecar) write(*sidecar, sidecar_text(notes, made.picture));
    if (options.depth_output) write(*options.depth_output, depth_bytes(options, picture));
  });
  made.report = text_report(options, record);
  made.json = json_report(options, record);
  if (options.report) write(*options.report, made.report);
  for (WholeFile& file : files) file.commit();
  if (options.output != "-") made.picture.clear();
  std::erase(warnings, "");
  made.warnings = std::move(warnings);
  return made;
}

/// `sequence` is of frames that depend on those before. `stand_ins` are kept over frames, or null.
Rendered make_rendered(const RenderOptions& options, const Scene& scene, double load_ms,
                       FrameSequence& sequence, std::shared_ptr<const StandIns> stand_ins,
                       Progress& progress, ThreadPool& pool) {
  Shot shot = asked_shot(options, scene, sequence);
  shot.stand_ins = std::move(stand_ins);
  RenderRecord record{.scene_name = scene.name,
                      .scene_title = scene.title,
                      .triangles = triangle_count(scene),
                      .camera = scene.camera,
                      .effects = shot.effects,
                      .ms = {.load = load_ms}};
  std::vector<std::string> warnings;
  const auto warn_of_frame = [&] {
    warnings.insert(warnings.end(), {until_warning(record), goal_warning(options, record),
                                     order_warning(record.effects)});
    if (options.show == Show::image) {
      warnings.push_back(shutter_warning(scene, options.method, record.effects));
    }
    std::erase(warnings, "");
  };
  if (may_render_by_rows(options)) {
    const std::string why = why_whole(shot, pool.isa());
    record.made = why.empty() ? "a band of rows at a time" : "whole: " + why;
    if (why.empty()) {
      StageWatch watch{progress, record.ms};
      render_by_rows(
          options, shot, record, warnings, [&](FrameStage stage) { watch.begin(stage); }, pool);
      progress.clear();
      warn_of_frame();
      return {.warnings = std::move(warnings),
              .report = text_report(options, record),
              .json = json_report(options, record)};
    }
    check_whole_memory(options);
  }
  record.frame = watched_frame(shot, options, record, warnings, progress, pool);
  record.camera.position = record.frame.view.eye;
  record.camera.target = target_at(scene.camera, shot.frame);
  progress.clear();
  if (options.shard) {
    write_shard(scene, options, record);
    std::erase(warnings, "");
    return {.warnings = std::move(warnings)};
  }
  warn_of_frame();
  return write_frame(options, record, std::move(warnings), progress, pool);
}

Scene loaded_scene(const RenderOptions& options, Progress& progress, double& ms, ThreadPool& pool) {
  Scene scene = timed(progress, "loading", ms, [&] {
    return load_scene(options.scene, scene_search_path(options.scene_path), &pool);
  });
  progress.clear();
  settle_scene(options, scene);
  for (std::string& warning : shadow_warnings(scene)) scene.warnings.push_back(std::move(warning));
  print_scene_warnings(scene.warnings, options.verbose);
  if (!options.quiet) {
    for (const std::string& note : scene.notes) tell(note);
  }
  check_shadow_memory(scene);
  check_scene_memory(options, scene);
  return scene;
}

int render(const RenderOptions& options) {
  const bool to_standard_output = options.output == "-";
  if (!to_standard_output) check_writable(options.output);
  if (options.report) check_writable(*options.report);
  if (options.depth_output) check_writable(*options.depth_output);

  Progress progress{options.quiet};
  ThreadPool pool{options.pool.threads, options.pool.isa};
  double load_ms = 0.0;
  const Scene scene = loaded_scene(options, progress, load_ms, pool);
  check_outputs(options, scene);
  checked_effect_of_frames(options, scene);
  if (options.shard && !options.effects.are_given && !scene.effects.empty()) {
    throw UsageError(
        "--shard: the scene has effects, and a shard is no picture; give --effect none, and to "
        "what join makes softfocus apply");
  }
  FrameSequence sequence = frame_sequence(options);
  const Rendered made = make_rendered(options, scene, load_ms, sequence, {}, progress, pool);
  if (to_standard_output) write_to_standard_output(made.picture);
  progress.clear();
  for (const std::string& warning : made.warnings) {
    warn(warning);
  }
  if (options.json) std::cout << made.json;
  if (options.verbose) std::cerr << made.report;
  return kDone;
}

int render_many(const RenderOptions& options, const CLI::App& parser) {
  Progress progress{options.quiet};
  double load_ms = 0.0;
  std::optional<ThreadPool> pool{std::in_place, options.pool.threads, options.pool.isa};
  const Scene scene = loaded_scene(options, progress, load_ms, *pool);
  std::shared_ptr<const StandIns> stand_ins;
  if (has_impostors(scene)) stand_ins = stand_ins_of(make_scene_impostors(scene, *pool));
  pool.reset();
  const bool depends = checked_effect_of_frames(options, scene).has_value();
  FrameSequence sequence = frame_sequence(options);
  return render_frames(options, parser, scene, [&](const RenderOptions& frame, FrameRun& run) {
    Progress silent{true};
    // Frames that do not depend on each other are made several at once.
    FrameSequence own = frame_sequence(frame);
    Rendered made =
        make_rendered(frame, scene, load_ms, depends ? sequence : own, stand_ins, silent, run.pool);
    run.picture = std::move(made.picture);
    run.warnings = std::move(made.warnings);
    run.report = std::move(made.report);
  });
}

}  // namespace

Command add_render_command(CLI::App& program) {
  CLI::App* parser = add_command(program, "render", "Render a scene to a picture");
  const auto options = std::make_shared<RenderOptions>();
  add_render_options(*parser, *options);
  return {parser, [parser, options] {
            complete(*options, *parser);
            if (options->sequence.frames) return render_many(*options, *parser);
            check_single_picture(*parser, options->output);
            options->lens = at_frame(options->lens, options->frame);
            return render(*options);
          }};
}

}  // namespace softfocus

// softfocus render: the way of a frame from a scene's file to a picture's.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <iostream>
#include <memory>
#include <span>
#include <vector>

#include "dof/show.h"
#include "scenes/auto/auto_picture.h"
#include "scenes/draw/frame_parts.h"
#include "scenes/draw/keyframes.h"
#include "scenes/draw/light_points.h"
#include "scenes/draw/object_numbers.h"
#include "scenes/draw/shadowed_layers.h"
#include "scenes/draw/surface_draws.h"
#include "scenes/draw/velocity.h"
#include "scenes/load/load_scene.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/cli/progress.h"
#include "tools/files/whole_file.h"
#include "tools/gl/frame_on_gl.h"
#include "tools/options/method_options.h"
#include "tools/options/run_options.h"
#include "tools/render/frame_lens.h"
#include "tools/render/frame_sequence.h"
#include "tools/render/options.h"
#include "tools/render/performance_report.h"
#include "tools/render/picture_files.h"
#include "tools/render/render_frames.h"
#include "tools/render/shard_file.h"
#include "tools/render/warnings.h"

namespace softfocus {
namespace {

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

bool needs_lens(const RenderOptions& options) {
  return options.show == Show::coc || has_depth_of_field(options);
}

/// What a method works from that draws the scene itself, from many points of the lens.
LensViewInput lens_view_input(const Scene& scene, const CameraMatrices& view, const Image& pinhole,
                              PreparedScene* prepared, const RenderOptions& options,
                              const RenderRecord& record, Progress& progress) {
  const UsedLens& used = *record.lens;
  const Sampling& sampling = record.used.sampling;
  const SampleRange range = samples_of(options.shard.value_or(Shard{}), sampling.samples);
  const std::string of_all = std::string{" of "} +
                             (sampling.until || sampling.by_tile ? "at most " : "") +
                             std::to_string(range.end - range.begin);
  return {scene,
          view,
          options.frame,
          pinhole,
          used.lens.focus_m,
          aperture_radius_m(used.lens, used.coc_scale),
          sampling,
          options.profile,
          [&progress, of_all](int samples) {
            progress.show("sampling the lens, " + std::to_string(samples) + of_all);
          },
          prepared};
}

Image sampled_picture(const LensViewInput& input, RenderRecord& record, ThreadPool& pool) {
  SampledPicture sampled = record.used.method.of_scene->render(input, pool);
  if (record.used.method.of_scene->samples_lens) {
    record.sampled = {sampled.samples, sampled.half_set_rms, sampled.mean_samples, sampled.unseen};
  }
  return std::move(sampled.picture);
}

/// The picture of what auto chooses.
Image auto_drawn(const Scene& scene, const CameraMatrices& view, const Image& pinhole,
                 PreparedScene* prepared, const RenderOptions& options, RenderRecord& record,
                 Progress& progress, ThreadPool& pool) {
  UsedLens& lens = *record.lens;
  StageTimes& ms = record.ms;
  using StageClock = std::chrono::steady_clock;
  StageClock::time_point begun = StageClock::now();
  double* stage_ms = &ms.choose;
  const auto end_stage = [&] {
    const StageClock::time_point now = StageClock::now();
    *stage_ms += std::chrono::duration<double, std::milli>(now - begun).count();
    begun = now;
  };
  const auto begin_stage = [&](AutoStage stage) {
    end_stage();
    static constexpr std::array kStageNames{"choosing", "filtering", "sampling the lens",
                                            "checking"};
    progress.show(kStageNames[static_cast<std::size_t>(stage)]);
    stage_ms = stage == AutoStage::choosing   ? &ms.choose
               : stage == AutoStage::checking ? &ms.check
                                              : &ms.filter;
  };
  const LensViewInput views{scene,
                            view,
                            options.frame,
                            pinhole,
                            lens.lens.focus_m,
                            aperture_radius_m(lens.lens, lens.coc_scale),
                            options.sampling,
                            options.profile,
                            {},
                            prepared};
  AutoPicture found = auto_picture({.views = views,
                                    .settings = lens.settings,
                                    .goal = options.goal,
                                    .limits = {options.max_coc_px, record.triangles},
                                    .verify = options.verify,
                                    .on_stage = begin_stage},
                                   pool);
  end_stage();
  UsedMethod& used = record.used;
  const AutoMethod& choice = found.choice;
  used.method = {find_method(choice.method), find_lens_view_method(choice.method)};
  if (choice.samples > 0) {
    used.sampling.samples = choice.samples;
    record.sampled = {choice.samples, {}, {}};
  } else {
    lens.settings.max_coc_px = choice.radius_px;
  }
  used.choice = choice;
  used.measured_error = found.measured_error;
  return std::move(found.picture);
}

/// `objects` and `radii_px` are what the filter reads beside the parts, if it does.
Image shown_picture(FrameParts parts, std::span<const std::uint16_t> objects,
                    std::span<const float> radii_px, const RenderOptions& options,
                    const Method* filter, const Camera& camera, const DofSettings& settings,
                    FrameOnGl* on_gl, ThreadPool& pool) {
  Image& scene = parts.picture;
  switch (options.show) {
    case Show::image:
      if (filter == nullptr) return std::move(scene);
      if (options.arithmetic != Arithmetic::floats) {
        Image result = make_image(scene.format, scene.width, scene.height);
        two_pass_in(options.arithmetic, {scene, settings, options.profile}, result, pool);
        return result;
      }
      return on_gl != nullptr ? on_gl->filter(*filter, settings, scene)
                              : with_dof_input(parts, settings, options.profile, objects, radii_px,
                                               [&](const DofInput& input) {
                                                 return apply(*filter, input, pool);
                                               });
    case Show::pinhole: return std::move(scene);
    case Show::coc: return show_coc(scene, settings.coc, settings.max_coc_px);
    case Show::depth:
      return show_depth(scene, static_cast<float>(camera.near_m), static_cast<float>(camera.far_m));
  }
  return std::move(scene);
}

/// Layers behind the first, each shown as the picture is.
void write_layers(std::vector<Image>& behind, const RenderOptions& options,
                  const RenderRecord& record, ThreadPool& pool,
                  std::vector<std::unique_ptr<WholeFile>>& files) {
  for (std::size_t i = 0; i < behind.size(); ++i) {
    const Image shown =
        shown_picture({std::move(behind[i]), {}, {}, {}}, {}, {}, options, nullptr, record.camera,
                      record.lens ? record.lens->settings : DofSettings{}, nullptr, pool);
    files.push_back(std::make_unique<WholeFile>(layer_place(options, i + 2)));
    files.back()->write(encode_with_notes(shown, options.format, notes_of(options, record)));
  }
}

/// What is said once the files are there.
struct Rendered {
  Bytes picture{};  ///< of -o -
  std::vector<std::string> warnings{};
  std::string report{}, json{};
};

/// `sequence` is of frames that depend on those before.
Rendered make_rendered(const RenderOptions& options, const Scene& scene, double load_ms,
                       FrameSequence& sequence, Progress& progress, ThreadPool& pool) {
  const bool to_standard_output = options.output == "-";
  RenderRecord record;
  StageTimes& ms = record.ms;
  ms.load = load_ms;
  record.scene_name = scene.name;
  record.scene_title = scene.title;
  record.triangles = triangle_count(scene);
  if (needs_lens(options))
    record.lens = chosen_lens(options, scene.lens, scene.camera.fov_y_degrees);

  const PictureSize drawn_in = drawn_size(options);
  const int width = drawn_in.width, height = drawn_in.height;
  std::optional<FrameOnGl> on_gl;
  if (options.gl != nullptr) {
    record.gl_renderer = on_gl.emplace(*options.gl, options.shaders).renderer();
  }
  const CameraMatrices view = camera_matrices(scene.camera, options.frame, width, height);
  record.camera = scene.camera;
  record.camera.position = view.eye;
  const std::optional<ChosenEffect> of_frames = checked_effect_of_frames(options, scene);
  std::optional<PreparedScene> prepared;
  FrameParts parts = timed(progress, "drawing", ms.draw, [&] {
    FrameParts drawn;
    if (on_gl && layers_of(options) == 1) {
      drawn.picture = on_gl->draw(scene, view, options.frame, width, height);
      return drawn;
    }
    if (on_gl) {
      drawn.behind =
          on_gl->draw_layers(scene, view, options.frame, width, height, layers_of(options));
      drawn.picture = std::move(drawn.behind.front());
      drawn.behind.erase(drawn.behind.begin());
      return drawn;
    }
    prepared = prepare_scene(scene, options.profile, pool);
    if (!of_frames || layers_of(options) > 1) {
      drawn = draw_parts(*prepared, view, options.frame, width, height, layers_of(options), pool);
    }
    if (of_frames) {
      draw_up_to(*prepared, *of_frames, options.frame, width, height, sequence, pool);
      // What is transparent is in the picture, and filtered with it.
      drawn.picture = sequence.history.picture;
      drawn.opaque = {};
      drawn.transparent.clear();
      record.shaded_share = sequence.history.shaded_share;
    }
    return drawn;
  });

  std::vector<std::string> warnings;
  DofSettings settings;
  if (record.lens) {
    timed(progress, "focusing", ms.focus,
          [&] { set_lens(*record.lens, parts, options, scene.camera.fov_y_degrees, pool); });
    settings = record.lens->settings;
    if (cuts_by_default(options))
      warnings.push_back(cut_warning(parts.picture, options, *record.lens, pool));
  }
  warnings.push_back(transparent_warning(scene, parts, options));
  record.used = {options.method, with_shutter_of(scene, options.sampling), {}, {}};
  const bool is_auto = options.show == Show::image && options.method.is_auto();
  const bool from_lens = options.show == Show::image && record.used.method.of_scene != nullptr;
  if (!from_lens && !is_auto) prepared.reset();
  std::vector<std::uint16_t> objects;
  if (options.show == Show::image && record.used.method.filter != nullptr && !on_gl) {
    objects = object_numbers_for(*record.used.method.filter, scene, view, options.frame, width,
                                 height, options.profile, pool);
  }
  std::vector<Image> behind;
  if (options.show != Show::image) behind = std::move(parts.behind);
  const auto make_picture = [&] {
    PreparedScene* const ready = prepared ? &*prepared : nullptr;
    if (is_auto) {
      return auto_drawn(scene, view, parts.picture, ready, options, record, progress, pool);
    }
    if (from_lens) {
      return sampled_picture(
          lens_view_input(scene, view, parts.picture, ready, options, record, progress), record,
          pool);
    }
    return shown_picture(
        std::move(parts), objects,
        record.lens ? std::span<const float>{record.lens->radii_px} : std::span<const float>{},
        options, record.used.method.filter, scene.camera, settings, on_gl ? &*on_gl : nullptr,
        pool);
  };
  if (options.shard) {
    timed(progress, "sampling", ms.filter, [&] {
      record.sampled = {options.sampling.samples, {}, {}};
      write_shard(
          lens_view_input(scene, view, parts.picture, &*prepared, options, record, progress),
          options, record, pool);
    });
    progress.clear();
    std::erase(warnings, "");
    return {.warnings = std::move(warnings)};
  }
  Image picture =
      is_auto ? make_picture()  // which times its stages itself
              : timed(progress, from_lens ? "sampling" : "filtering", ms.filter, make_picture);

  if (options.supersample == 2) {
    double halve_ms = 0.0;
    picture = timed(progress, "halving", halve_ms, [&] {
      return halved(picture, options, scene.camera.fov_y_degrees, record.lens, pool);
    });
    ms.filter += halve_ms;
  }
  record.effects =
      all_effects(options.effects, options.show == Show::image ? std::span{scene.effects}
                                                               : std::span<const ChosenEffect>{});
  if (!record.effects.empty()) {
    double effects_ms = 0.0;
    picture = timed(progress, "effects", effects_ms, [&] {
      const auto make_velocity = [&](const ChosenEffect& chosen, const Image& of) {
        return velocity_for(chosen, scene, options.frame, of, options.profile, pool);
      };
      return with_effects(std::move(picture), record.effects, make_velocity, options.profile, pool);
    });
    ms.filter += effects_ms;
  }
  progress.clear();
  warnings.insert(warnings.end(), {until_warning(record), goal_warning(options, record),
                                   order_warning(record.effects)});
  if (options.show == Show::image) {
    warnings.push_back(shutter_warning(scene, options.method, record.effects));
  }
  auto sidecar = sidecar_place(options);
  if (sidecar && !is_free_for_sidecar(*sidecar)) {
    warnings.push_back("'" + sidecar->string() +
                       "' is no sidecar of a picture and stays as it is: the picture's lens is "
                       "written nowhere");
    sidecar.reset();
  }

  Bytes bytes = timed(progress, "encoding", ms.encode, [&] {
    record.picture_hash = hash_image(picture);
    return encode_with_notes(picture, options.format, notes_of(options, record));
  });
  std::vector<std::unique_ptr<WholeFile>> layer_files;
  if (options.show != Show::image) write_layers(behind, options, record, pool, layer_files);
  // The files get their names together, when nothing can fail but the naming.
  std::optional<WholeFile> picture_file, sidecar_file, report_file, depth_file;
  timed(progress, "writing", ms.write, [&] {
    if (!to_standard_output) picture_file.emplace(options.output).write(bytes);
    if (sidecar) {
      sidecar_file.emplace(*sidecar).write(sidecar_text(notes_of(options, record), bytes));
    }
    if (options.depth_output) {
      depth_file.emplace(*options.depth_output).write(depth_bytes(options, picture));
    }
  });
  Rendered made{.report = text_report(options, record), .json = json_report(options, record)};
  if (options.report) report_file.emplace(*options.report).write(made.report);
  if (picture_file) picture_file->commit();
  for (const auto& file : layer_files) file->commit();
  if (sidecar_file) sidecar_file->commit();
  if (depth_file) depth_file->commit();
  if (report_file) report_file->commit();
  if (to_standard_output) made.picture = std::move(bytes);
  std::erase(warnings, "");
  made.warnings = std::move(warnings);
  return made;
}

Scene loaded_scene(const RenderOptions& options, Progress& progress, double& ms) {
  Scene scene = timed(progress, "loading", ms, [&] {
    return load_scene(options.scene, scene_search_path(options.scene_path));
  });
  progress.clear();
  settle_shadows(options, scene);
  for (std::string& warning : shadow_warnings(scene)) scene.warnings.push_back(std::move(warning));
  print_scene_warnings(scene.warnings, options.verbose);
  if (has_transparent(scene)) check_transparent_memory(options);
  if (has_soft_shadows(scene)) check_soft_memory(options);
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
  const Scene scene = loaded_scene(options, progress, load_ms);
  check_outputs(options, scene);
  checked_effect_of_frames(options, scene);
  if (options.shard && !options.effects.are_given && !scene.effects.empty()) {
    throw UsageError(
        "--shard: the scene has effects, and a shard is no picture; give --effect none, and to "
        "what join makes softfocus apply");
  }
  FrameSequence sequence = frame_sequence(options);
  const Rendered made = make_rendered(options, scene, load_ms, sequence, progress, pool);
  if (to_standard_output) write_to_standard_output(made.picture);
  progress.clear();
  for (const std::string& warning : made.warnings) {
    std::cerr << "softfocus: warning: " << warning << '\n';
  }
  if (options.json) std::cout << made.json;
  if (options.verbose) std::cerr << made.report;
  return kDone;
}

int render_many(const RenderOptions& options, const CLI::App& parser) {
  Progress progress{options.quiet};
  double load_ms = 0.0;
  const Scene scene = loaded_scene(options, progress, load_ms);
  const bool depends = checked_effect_of_frames(options, scene).has_value();
  FrameSequence sequence = frame_sequence(options);
  return render_frames(options, parser, scene, [&](const RenderOptions& frame, FrameRun& run) {
    Progress silent{true};
    // Frames that do not depend on each other are made several at once.
    FrameSequence own = frame_sequence(frame);
    Rendered made =
        make_rendered(frame, scene, load_ms, depends ? sequence : own, silent, run.pool);
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

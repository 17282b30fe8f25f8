#include "tools/bench/options.h"

#include <algorithm>
#include <variant>

#include "scenes/load/pipeline_file.h"
#include "scenes/make/shapes.h"
#include "scenes/temporal/frame_history.h"
#include "tools/cli/errors.h"
#include "tools/gl/shaders.h"
#include "tools/options/effect_options.h"
#include "tools/options/run_options.h"

namespace softfocus {
namespace {

constexpr int kLeastRuns = 10;
constexpr int kMostRuns = 1000;

/// A drawn and a filtered picture, one between (8 bytes a pixel each) and depth (4), for
/// each of the two contenders; two pictures read back and compared.
constexpr std::uint64_t kBenchBytesPerPixel = 72;

/// And for a method that draws the scene: two sets of sums (32 bytes each), a picture and its
/// depth; for filtered-views the eight views of a group (8 bytes each).
constexpr std::uint64_t kLensSumBytesPerPixel = 2 * 32 + 12;
constexpr std::uint64_t kFilteredViewsBytesPerPixel = 8 * 8;
/// Each drawn view that is warped takes four planes of binary32.
constexpr std::uint64_t kWarpedViewBytesPerPixel = 4 * 4;

/// For effects that read the frames before: of the history five pictures (8 bytes each), a
/// velocity (4) and two counts (4 each); a driver has three of those pictures, velocity and count,
/// and of triangles and of quads a picture between and what the passes make (20).
constexpr std::uint64_t kFramesBytesPerPixel = 5 * 8 + 3 * 4 + 3 * 8 + 2 * 4 + 2 * 20;

bool makes_frames(const Effect& effect) { return effect.filter == nullptr; }

/// `all` are those for which there is something to read: of a picture nothing moves.
void choose_all_effects(BenchOptions& options) {
  for (const Effect& effect : effects()) {
    const bool reads_more = makes_frames(effect) || effect.velocity != VelocityOf::nothing;
    if (options.image && reads_more) continue;
    options.effects.push_back(parse_effect("--effect", std::string{effect.name}));
  }
}

/// A frame that is only ever drawn has no passes.
void check_passes(const ChosenEffect& chosen) {
  const FrameEffect effect = frame_effect(chosen);
  const auto* reproject = std::get_if<Reproject>(&effect);
  if (reproject != nullptr && reproject->every == 1) {
    throw UsageError(
        "--effect: reproject:every=1 draws every frame, so that there is no pass to "
        "time; give an every of 2 or more");
  }
}

/// Effects read what is sharp.
void check_effects(BenchOptions& options, const CLI::App& parser) {
  if (options.all_effects) choose_all_effects(options);
  for (const char* option : {"--method", "--arithmetic", "--max-coc"}) {
    if (is_given(parser, option)) {
      throw UsageError(std::string{"--effect and "} + option +
                       " exclude each other: effects are timed alone, on the sharp picture");
    }
  }
  for (const ChosenEffect& chosen : options.effects) {
    const std::string name{chosen.effect->name};
    const bool reads_velocity = chosen.effect->velocity != VelocityOf::nothing;
    if (options.image && (makes_frames(*chosen.effect) || reads_velocity)) {
      throw UsageError("--image and --effect " + name + " exclude each other: it reads " +
                       (reads_velocity ? "a velocity" : "the frames before") +
                       "; give a SCENE that moves");
    }
    if (makes_frames(*chosen.effect)) check_passes(chosen);
  }
  options.method = {.filter = find_method("pinhole")};
}

/// Checks the options that the method needs.
void check_method(BenchOptions& options, const CLI::App& parser) {
  const MethodChoice& method = options.method;
  const std::string name{method.name()};
  check_auto_options(parser, method);
  check_arithmetic(options.arithmetic, name, options.versus != nullptr);
  if (method.of_scene != nullptr && method.of_scene->samples_lens) {
    complete_sampling(options.sampling, *method.of_scene, parser);
  } else if (!method.is_auto()) {
    refuse_sampling_options(parser, name);
  }
  if (options.image && method.filter == nullptr) {
    throw UsageError("--image and --method " + name + " exclude each other: the method " +
                     (method.is_auto() ? "may draw" : "draws") +
                     " the scene; give a SCENE or --triangles N");
  }
  if (options.versus != nullptr && name != "pinhole" && !has_shader(name) &&
      !is_pipeline_name(name)) {
    throw UsageError(
        "--vs and --method " + name +
        " exclude each other: only two-pass, one-pass and pipelines have a shader for a driver; "
        "--method pinhole compares drawing alone");
  }
}

void add_subject_options(CLI::App& parser, BenchOptions& options) {
  add_optional_argument(parser, "SCENE", "A scene or a file, as render takes it", options.scene);
  offer(parser, "SCENE", known_scenes);
  begin_group(parser, "What is timed");
  const std::string numbers =
      std::to_string(kLeastFieldTriangles) + " to " + std::to_string(kMostFieldTriangles);
  add_value(parser, "--triangles", "N",
            "Instead of SCENE: 250 spheres of N triangles in all, " + numbers,
            [&options, numbers](const std::string& text) {
              options.triangles = parse_whole("--triangles", text, kLeastFieldTriangles,
                                              kMostFieldTriangles, "a number from " + numbers);
            });
  add_value(parser, "--image", "WxH",
            "Instead of SCENE: a picture of that size that nothing draws, for the filter alone",
            [&options](const std::string& text) { options.image = parse_size("--image", text); });
  add_size(parser, options.size);
  add_multisample(parser, options.samples);
  add_frame(parser, options.frame);
  add_value(parser, "--frames", "A..B[:STEP]",
            "Time these frames too, one after the other as a player shows them",
            [&options](const std::string& text) {
              options.frames = parse_frame_range("--frames", text);
            });
  add_scene_path(parser, options.scene_path);
}

}  // namespace

void add_bench_options(CLI::App& parser, BenchOptions& options) {
  add_subject_options(parser, options);
  begin_group(parser, "Lens");
  add_lens_options(parser, options.lens);
  begin_group(parser, "Method");
  add_method_option(parser, options.method);
  add_arithmetic_option(parser, options.arithmetic);
  add_max_coc_option(parser, options.max_coc_px);
  begin_group(parser, "Effects, in place of a method");
  add_repeatable_value(parser, "--effect", "NAME:KEY=VALUE,...",
                       "Time this effect on the sharp picture (softfocus effects); several one by "
                       "one; all: each, of --image those that read one picture",
                       [&options](const std::string& text) {
                         if (text == "all") {
                           options.all_effects = true;
                         } else {
                           options.effects.push_back(parse_effect("--effect", text));
                         }
                       });
  offer(parser, "--effect", [] { return names_in(effects()); });
  begin_group(parser, "Methods that sample the lens");
  add_sampling_options(parser, options.sampling);
  begin_group(parser, "The method auto");
  add_auto_options(parser, options.goal, options.verify);
  begin_group(parser, "Run");
  add_profile_option(parser, options.profile, options.profile_name);
  add_pool_options(parser, options.pool, "the picture is the same");
  add_value(parser, "--runs", "N", "Times that each is run and timed, 10 to 1000 (default: 15)",
            [&options](const std::string& text) {
              options.runs =
                  parse_whole("--runs", text, kLeastRuns, kMostRuns, "a number from 10 to 1000");
            });
  add_value(parser, "--vs", "DRIVER", "Time this GL driver too, in turn: " + names_of(drivers()),
            [&options](const std::string& text) { options.versus = &parse_driver("--vs", text); });
  offer(parser, "--vs", [] { return names_in(drivers()); });
  add_flag(parser, "--copy",
           "Time the frame also with a copy of each pass's picture into a texture, as before there "
           "were frame-buffer objects",
           options.copies);
  add_flag(parser, "--json", "Print JSON", options.json);
  add_quiet_option(parser, options.quiet);
}

void complete(BenchOptions& options, const CLI::App& parser) {
  const int given =
      (options.scene.empty() ? 0 : 1) + (options.triangles ? 1 : 0) + (options.image ? 1 : 0);
  if (given != 1) {
    throw UsageError(std::string{given == 0 ? "nothing to measure is given"
                                            : "more than one thing to measure is given"} +
                     "; give a SCENE (softfocus scenes), --triangles N or --image WxH");
  }
  if (options.image && is_given(parser, "--size")) {
    throw UsageError("--image and --size exclude each other: --image has the size");
  }
  if (options.image) options.size = *options.image;
  if (options.samples > 1 &&
      (options.image || options.versus != nullptr || options.method.filter == nullptr ||
       options.all_effects || !options.effects.empty() ||
       options.arithmetic != Arithmetic::floats ||
       options.profile.coverage != Coverage::edge_functions)) {
    throw UsageError(
        "--multisample needs a SCENE or --triangles N that is drawn and filtered, without --vs, "
        "--effect, --arithmetic and --profile softpipe");
  }
  if (options.frames && (options.scene.empty() || options.all_effects || !options.effects.empty() ||
                         options.arithmetic != Arithmetic::floats)) {
    throw UsageError(
        "--frames needs a SCENE, which is drawn and filtered: not --triangles, --image, --effect "
        "or --arithmetic");
  }
  if (options.all_effects || !options.effects.empty()) check_effects(options, parser);
  check_method(options, parser);
  if (options.copies && (options.image || options.method.filter == nullptr ||
                         options.method.name() == "pinhole" || !options.effects.empty())) {
    throw UsageError(
        "--copy needs a frame that is drawn and filtered: a SCENE or --triangles N, and a --method "
        "that filters its picture");
  }
  const bool reads_history =
      std::any_of(options.effects.begin(), options.effects.end(),
                  [](const ChosenEffect& chosen) { return makes_frames(*chosen.effect); });
  check_memory(
      options.image ? "--image" : "--size", options.size,
      kBenchBytesPerPixel + (options.method.filter == nullptr ? kLensSumBytesPerPixel : 0) +
          (options.method.name() == "filtered-views" ? kFilteredViewsBytesPerPixel : 0) +
          (options.method.of_scene != nullptr && options.method.of_scene->warps_views
               ? static_cast<std::uint64_t>(options.sampling.drawn_views) * kWarpedViewBytesPerPixel
               : 0) +
          (reads_history ? kFramesBytesPerPixel : 0));
}

}  // namespace softfocus

#include "tools/render/options.h"

#include <algorithm>
#include <cstdint>
#include <string>

#include "raster/images/image.h"
#include "raster/pipeline/merge.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/draw/frame_matrices.h"
#include "scenes/draw/light_points.h"
#include "scenes/draw/shadowed_layers.h"
#include "scenes/parameters.h"
#include "tools/cli/errors.h"
#include "tools/cli/platform.h"
#include "tools/files/whole_file.h"
#include "tools/options/method_options.h"
#include "tools/options/parameter_options.h"
#include "tools/options/run_options.h"
#include "tools/render/picture_files.h"
#include "tools/render/render_by_rows.h"
#include "tools/render/shard_file.h"

namespace softfocus {
namespace {

void add_picture_options(CLI::App& parser, RenderOptions& options) {
  begin_group(parser, "Output");
  add_text(parser, "-o,--output", "FILE",
           "The picture: .png, .exr, .tiff, .pfm, .hdr or .npy; - for standard output (required)",
           options.output);
  add_format_option(parser, options.format);
  add_value(parser, "--depth-output", "FILE",
            "The depth too, in metres along the axis: .pfm, .npy, .exr (channel Z), or .png (16 "
            "bits, millimetres)",
            [&options](const std::string& text) {
              const auto format = format_by_extension(text);
              if (!format || *format == FileFormat::hdr) {
                throw UsageError("--depth-output '" + text +
                                 "': the name must end in .pfm, .npy, .exr or .png");
              }
              if (!missing_format(*format).empty()) {
                throw UsageError("--depth-output '" + text +
                                 "': " + std::string{missing_format(*format)});
              }
              options.depth_output = text;
            });
  add_text(parser, "--report", "FILE", "Write a performance report, times in milliseconds",
           options.report);
  add_flag(parser, "--json", "Print the report as JSON on standard output", options.json);
  begin_group(parser, "Picture");
  add_size(parser, options.size);
  add_value(
      parser, "--supersample", "1|2",
      "Draw and filter at so many times the width and height; 2 makes edges smooth (default: 1)",
      [&options](const std::string& text) {
        options.supersample = parse_whole("--supersample", text, 1, 2, "1 or 2");
      });
  add_multisample(parser, options.samples);
  add_choice(parser, "--show",
             "The picture with depth of field, without, or a grey map (default: image)", kShows,
             options.show);
  add_effect_options(parser, options.effects);
  add_value(parser, "--layers", "K",
            "The K nearest surfaces of each pixel, 1 to 4: what layered works from (default: 2); "
            "with --show pinhole, coc or depth a FILE for each, FILE.layer2 and so on",
            [&options](const std::string& text) {
              options.layers = static_cast<std::size_t>(parse_whole(
                  "--layers", text, 1, static_cast<int>(kMaxLayers), "a number from 1 to 4"));
            });
}

void add_scene_options(CLI::App& parser, RenderOptions& options) {
  begin_group(parser, "Scene");
  add_frame(parser, options.frame);
  add_scene_path(parser, options.scene_path);
  add_look_options(parser, options.look);
  add_map_option(parser, options.map);
  add_light_options(parser, options.lights);
  add_terminator_option(parser, options.lights);
  add_sequence_options(parser, options.sequence,
                       "Of --frames only every N-th, from the I-th on; without them, of "
                       "accumulation, the I-th of N parts of the samples: FILE, a .sum, gets their "
                       "sums, which softfocus join joins");
}

void add_lens_and_method_options(CLI::App& parser, RenderOptions& options) {
  begin_group(parser, "Lens");
  add_animated_lens_options(parser, options.lens);
  add_value(parser, "--autofocus", "[X,Y]",
            "Focus on what is at this pixel, from the top left (default: the centre)",
            [&options](const std::string& text) {
              options.autofocus = true;
              if (text != "centre") options.autofocus_pixel = parse_pixel("--autofocus", text);
            });
  add_value(parser, "--focus-at", "X,Y", "The same, at a pixel, as refocus has it",
            [&options](const std::string& text) {
              options.autofocus = true;
              options.autofocus_pixel = parse_pixel("--focus-at", text);
            });
  add_sharp_depths_option(parser, options.sharp_depths);
  begin_group(parser, "Method");
  add_method_option(parser, options.method);
  add_arithmetic_option(parser, options.arithmetic);
  add_max_coc_option(parser, options.max_coc_px);
  add_weight_options(parser, options.leak, options.budget);
  begin_group(parser, "Methods that sample the lens");
  add_sampling_options(parser, options.sampling);
  begin_group(parser, "The method " + std::string{kApertureMethod});
  add_aperture_options(parser, options.aperture);
  begin_group(parser, "The method auto");
  add_auto_options(parser, options.goal, options.verify);
}

void add_run_options(CLI::App& parser, RenderOptions& options) {
  begin_group(parser, "Run");
  add_profile_option(
      parser,
      "Whose arithmetic to repeat to the bit: the standard's or a driver's (default: " +
          options.profile_name + ")",
      [&options](const ChosenProfile& chosen) {
        options.profile = chosen.profile;
        options.profile_name = chosen.name;
        options.profile_file = chosen.file;
      });
  add_value(parser, "--gl", "DRIVER", "Render on this GL driver instead of the emulation",
            [&options](const std::string& text) { options.gl = &parse_driver("--gl", text); });
  offer(parser, "--gl", [] { return names_in(drivers()); });
  add_shaders_option(parser, options.shaders);
  add_pool_options(parser, options.pool, "the picture is the same");
  add_talk_options(parser, options.verbose, options.quiet);
}

// Files of their own, or a method that reads them.
void check_layers(const RenderOptions& options) {
  if (!options.layers) return;
  if (options.show == Show::image) {
    if (options.method.layers() > 1) return;
    throw UsageError(
        "--layers: the method " + std::string{options.method.name()} +
        " looks at the nearest surface alone; give --method layered or --show pinhole");
  }
  if (options.output == "-" && *options.layers > 1) {
    throw UsageError("--layers and -o - exclude each other: each layer is a file; give -o a file");
  }
}

void check_depth_output(const RenderOptions& options) {
  if (!options.depth_output) return;
  if (is_map(options.show)) {
    throw UsageError("--depth-output: give it with --show image or pinhole");
  }
  if (is_same_file(*options.depth_output, options.output) ||
      (options.report && is_same_file(*options.depth_output, *options.report))) {
    throw UsageError("--depth-output '" + *options.depth_output +
                     "' names another output's file; give another name");
  }
}

void check_gl_options(const RenderOptions& options, const CLI::App& parser) {
  if (options.gl == nullptr) {
    return refuse_given(parser, {"--shaders"}, "a driver runs them; give --gl DRIVER too");
  }
  if (is_given(parser, "--profile")) {
    throw UsageError("--gl and --profile exclude each other: a driver is what it is");
  }
  const std::string method{options.method.name()};
  if (options.method.of_scene != nullptr) {
    throw UsageError("--gl and --method " + method +
                     " exclude each other: it draws in the emulation; give one");
  }
  const bool filters = options.show == Show::image && method != "pinhole";
  if (filters && !has_shader(method)) {
    throw UsageError("--gl and --method " + method +
                     " exclude each other: it has no shader; two-pass and one-pass have");
  }
  const auto names = frame_shaders(filters ? method : "");
  if (!has_no_part(options.shaders, names)) return;
  std::string list;
  for (const std::string_view name : names) {
    list += (list.empty() ? "" : ", ") + std::string{name};
  }
  throw UsageError("--shaders '" + options.shaders.folder.string() +
                   "': what differs there from the project's has no part in this picture, which is "
                   "made by " +
                   list + " and what they include");
}

void check_supersample(const RenderOptions& options) {
  if (options.supersample == 1) return;
  if (is_map(options.show)) {
    throw UsageError(
        "--supersample: a map of circles or depths has no mean; give --show image or "
        "pinhole");
  }
  if (options.layers) {
    throw UsageError(
        "--supersample and --layers exclude each other: neighbours in a layer may be of "
        "different surfaces, which have no mean");
  }
  if (options.method.is_auto() && options.show == Show::image) {
    throw UsageError("--supersample and --method auto exclude each other; name a method");
  }
  if (options.method.of_scene != nullptr && options.show == Show::image) {
    throw UsageError(
        "--supersample and --method " + std::string{options.method.name()} +
        " exclude each other: its views can look from all over a pixel; give --jitter");
  }
  const auto [width, height] = drawn_size(options);
  if (std::max(width, height) > kMaxImageSize) {
    throw UsageError("--supersample: " + size_text({width, height}) + " would be drawn, and " +
                     std::to_string(kMaxImageSize) + " is the most; give a smaller --size");
  }
  const float most = kLargestMaxCoc / static_cast<float>(options.supersample);
  if (options.max_coc_px.value_or(0.0f) > most) {
    throw UsageError("--supersample: --max-coc is at most " +
                     std::to_string(static_cast<int>(most)) + " with it");
  }
}

/// Why a pixel has one sample, in words that go behind the option's name; empty if it may have
/// several.
std::string why_one_sample(const RenderOptions& options) {
  if (is_map(options.show)) {
    return ": a map shows one surface a pixel; give --show image or pinhole";
  }
  if (options.show == Show::pinhole && options.layers.value_or(1) > 1) {
    return " and --layers exclude each other: a layer shows one surface a pixel";
  }
  if (options.profile.coverage != Coverage::edge_functions) {
    return " and --profile " + options.profile_name +
           " exclude each other: pixels covered by scanlines, as softpipe's, have one sample";
  }
  if (options.arithmetic != Arithmetic::floats) {
    return " and --arithmetic exclude each other: edges are of floats";
  }
  if (options.gl != nullptr) {
    return " and --gl exclude each other: the driver's picture has no edges";
  }
  if (!options.sharp_depths.empty()) {
    return " and --sharp-depths exclude each other: radii are of one surface a pixel";
  }
  if (options.show != Show::image) return "";
  if (options.method.is_auto()) return " and --method auto exclude each other; name a method";
  if (options.method.of_scene == nullptr) return "";
  return " and --method " + std::string{options.method.name()} +
         " exclude each other: its views can look from all over a pixel; give --jitter";
}

void settle_samples(RenderOptions& options, const CLI::App& parser) {
  options.samples_are_given = is_given(parser, "--multisample");
  const std::string why = why_one_sample(options);
  if (!options.samples_are_given) {
    // A driver's profile and one's own shaders are for their picture, and what a filter reads has
    // one surface a pixel.
    const Method* const filter = options.method.filter;
    const bool is_for_others = options.profile != Profile{} || options.show == Show::pinhole ||
                               (filter != nullptr && filter->pipeline != nullptr);
    if (!why.empty() || is_for_others) options.samples = 1;
  } else if (options.samples > 1 && !why.empty()) {
    throw UsageError("--multisample" + why);
  }
}

/// Blades are of the methods that sample the lens, too; turned and stretched are those of one
/// alone.
void check_blades(RenderOptions& options, const CLI::App& parser) {
  options.aperture.blades = options.sampling.aperture.blades;
  if (!options.method.samples_lens()) {
    check_aperture(parser, options.method.name(), names_of_sampling_methods());
    return;
  }
  refuse_given(parser, {"--aperture-turn", "--anamorphic"},
               "the method " + std::string{options.method.name()} +
                   " has blades alone; give --method " + std::string{kApertureMethod});
}

/// Enough for the drawn and the filtered picture and one between (8 bytes a pixel each),
/// depth (4) and the largest encoding (12).
constexpr std::uint64_t kRenderBytesPerPixel = 40;

/// And for each layer behind the first: a picture and its depth.
constexpr std::uint64_t kLayerBytesPerPixel = 12;

/// And for a method that draws the scene: two sets of sums (32 bytes each), a picture and its
/// depth; for filtered-views the eight views of a group (8 bytes each).
constexpr std::uint64_t kSamplingBytesPerPixel = 2 * 32 + 12;
constexpr std::uint64_t kFilteredBytesPerPixel = kSamplingBytesPerPixel + 8 * 8;
/// Each drawn view that is warped takes four planes of binary32.
constexpr std::uint64_t kWarpedBytesPerPixel = 4 * 4;

/// And for transparent surfaces: four layers with their depths (12 bytes each), two pictures of
/// each for the filter, and the opaque picture.
constexpr std::uint64_t kTransparentBytesPerPixel = 4 * 12 + 8 * 8 + 8;

/// And for soft shadows: sums of three colours, of each layer.
constexpr std::uint64_t kSoftBytesPerPixel = 3 * 8;

/// And for frames from those before: four pictures, a velocity (4 bytes) and counts (4), and what
/// draws the velocity (12).
constexpr std::uint64_t kHistoryBytesPerPixel = 4 * 8 + 4 + 4 + 12;

/// And for edges: another surface and its part, and what the filter sees. Where they are not found
/// in lanes, a picture of each sample with its depth.
constexpr std::uint64_t kEdgeBytesPerPixel = 8 + 1 + 8;
constexpr std::uint64_t kSampleBytesPerPixel = 12;

std::uint64_t bytes_per_pixel(const RenderOptions& options) {
  const std::vector<ChosenEffect>& effects = options.effects.effects;
  const bool has_history =
      std::any_of(effects.begin(), effects.end(),
                  [](const ChosenEffect& chosen) { return is_of_frames(*chosen.effect); });
  const bool may_sample = options.method.filter == nullptr;
  const bool may_filter_views = options.method.name() == "filtered-views";
  return kRenderBytesPerPixel + (options.samples > 1 ? kEdgeBytesPerPixel : 0) +
         (has_history ? kHistoryBytesPerPixel : 0) +
         (layers_of(options) - 1) * kLayerBytesPerPixel +
         (options.method.warps_views()
              ? static_cast<std::uint64_t>(options.sampling.drawn_views) * kWarpedBytesPerPixel
              : 0) +
         (may_filter_views ? kFilteredBytesPerPixel
          : may_sample     ? kSamplingBytesPerPixel
                           : 0);
}

void check_render_memory(const RenderOptions& options, std::uint64_t each_pixel) {
  check_memory(options.supersample == 1 ? "--size" : "--supersample", drawn_size(options),
               each_pixel);
}

}  // namespace

void settle_scene(const RenderOptions& options, Scene& scene) {
  set_look(options.look, scene);
  set_maps(options.map, scene);
  set_lights(options.lights, scene);
  if (!has_shadows(scene)) return;
  const std::string_view method = options.method.name();
  const bool is_without = method == "ray-traced" || method == "surface-splatting";
  if (options.gl == nullptr && !(is_without && options.show == Show::image)) return;
  throw UsageError(
      (options.gl != nullptr ? std::string{"--gl"} : "--method " + std::string{method}) +
      ": draws no shadows; --shadows none would leave them out");
}

namespace {

/// Whether samples are drawn as a picture of their own, with a row for each.
bool has_sample_rows(const Scene& scene) {
  return has_shaders(scene) || chunks_of_scene(scene) > kPassChunks;
}

}  // namespace

void check_scene_memory(const RenderOptions& options, const Scene& scene) {
  const auto samples = static_cast<std::uint64_t>(options.samples > 1 ? options.samples : 0);
  const std::uint64_t more =
      (has_transparent(scene) ? kTransparentBytesPerPixel : 0) +
      (has_soft_shadows(scene) ? layers_of(options) * kSoftBytesPerPixel : 0) +
      (has_sample_rows(scene) ? samples * kSampleBytesPerPixel : 0);
  if (more > 0) check_render_memory(options, bytes_per_pixel(options) + more);
}

PictureSize drawn_size(const RenderOptions& options) {
  return {options.size.width * options.supersample, options.size.height * options.supersample};
}

std::size_t layers_of(const RenderOptions& options) {
  return options.layers.value_or(options.show == Show::image ? options.method.layers() : 1);
}

std::uint64_t bytes_of_a_frame(const RenderOptions& options) {
  const auto [width, height] = drawn_size(options);
  return (bytes_per_pixel(options) + kTransparentBytesPerPixel) *
         static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
}

void add_render_options(CLI::App& parser, RenderOptions& options) {
  add_scene_argument(parser, options.scene);
  add_scene_options(parser, options);
  add_picture_options(parser, options);
  add_lens_and_method_options(parser, options);
  add_run_options(parser, options);
}

void complete(RenderOptions& options, const CLI::App& parser) {
  check_talk(parser);
  const bool to_standard_output = options.output == "-";
  if (!options.sequence.frames) options.shard = options.sequence.shard;
  if (options.shard) {
    check_shard_options(options, parser);
  } else {
    settle_format(parser, options.output, options.format);
  }
  if (to_standard_output && options.json) {
    throw UsageError("--json and -o - would both write to standard output; give -o a file");
  }
  if (to_standard_output && is_terminal(kStandardOutput)) {
    throw UsageError("-o -: standard output is a terminal; send it to a file or a program");
  }
  if (!is_given(parser, "--method")) options.method = default_method(parser, options.profile);
  check_gl_options(options, parser);
  if (options.report && options.report->empty()) {
    throw UsageError("--report '': give the name of a file");
  }
  if (options.report && is_same_file(*options.report, options.output)) {
    throw UsageError("--report and -o name the same file; give two");
  }
  check_depth_output(options);
  check_one_of(parser, {"--frame", "--frames"});
  check_one_of(parser, {"--focus", "--autofocus", "--focus-at"});
  if (options.autofocus_pixel) {
    const auto [x, y] = *options.autofocus_pixel;
    const auto [width, height] = options.size;
    if (x < 0 || x >= width || y < 0 || y >= height) {
      throw UsageError((is_given(parser, "--focus-at") ? "--focus-at " : "--autofocus ") +
                       std::to_string(x) + "," + std::to_string(y) +
                       ": the pixel must lie in the picture, 0,0 to " + std::to_string(width - 1) +
                       "," + std::to_string(height - 1));
    }
  }
  check_sharp_depths(parser, options.method, options.show == Show::image);
  check_budget(parser, options.method.name());
  check_layers(options);
  check_auto_options(parser, options.method);
  check_arithmetic(options.arithmetic, options.method.name(), options.gl != nullptr);
  check_blades(options, parser);
  if (options.method.samples_lens()) {
    complete_sampling(options.sampling, *options.method.of_scene, parser);
  } else if (!options.method.is_auto()) {
    refuse_sampling_options(parser, options.method.name());
  }
  if (options.shard) check_shard_count(*options.shard, options.sampling.samples);
  check_supersample(options);
  settle_samples(options, parser);
  if (!all_effects(options.effects).empty() && is_map(options.show)) {
    throw UsageError(
        "--effect: a map of circles or depths is no picture; give --show image or pinhole");
  }
  if (!all_effects(options.effects).empty() && options.shard) {
    throw UsageError(
        "--effect and --shard exclude each other; softfocus apply puts effects on what join gives");
  }
  if (!may_render_by_rows(options)) check_whole_memory(options);
}

void check_whole_memory(const RenderOptions& options) {
  check_render_memory(options, bytes_per_pixel(options));
}

std::vector<std::string> with_autofocus_joined(std::vector<std::string> arguments) {
  std::vector<std::string> joined;
  bool is_option = true;  // until `--`
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    joined.push_back(std::move(arguments[i]));
    if (joined.back() == "--") is_option = false;
    if (!is_option || joined.back() != "--autofocus") continue;
    const bool has_next = i + 1 < arguments.size();
    const std::string next = has_next ? arguments[i + 1] : "";
    // No scene is named with these characters alone; a mistyped pixel is.
    const bool is_pixel = next.find_first_of("0123456789") != next.npos &&
                          next.find_first_not_of("0123456789+-.,;x: ") == next.npos;
    joined.back() += "=" + (is_pixel || next == "centre" ? arguments[++i] : "centre");
  }
  return joined;
}

namespace {

std::vector<ChosenEffect> effects_on(const RenderOptions& options, const Scene& scene) {
  return all_effects(options.effects, options.show == Show::image
                                          ? std::span{scene.effects}
                                          : std::span<const ChosenEffect>{});
}

ShotLens asked_lens(const RenderOptions& options, const Scene& scene) {
  ShotLens asked{overruled(lens_at(scene.lens, options.frame), options.lens),
                 options.lens.coc_scale.value_or(scene.lens.coc_scale)};
  const auto scale = static_cast<float>(options.supersample);
  asked.settings.max_coc_px = std::min(
      scale * used_max_coc_px(options.max_coc_px, scene.lens, options.size.height), kLargestMaxCoc);
  asked.settings.leak = options.leak;
  asked.settings.budget = options.budget;
  asked.settings.aperture = options.aperture;
  asked.cuts_no_circle = takes_all_circles(options);
  if (options.autofocus) {
    const auto [x, y] =
        options.autofocus_pixel.value_or(Pixel{options.size.width / 2, options.size.height / 2});
    asked.focus_at = {x, y};
    asked.focuses_on_a_thing = !options.autofocus_pixel;
  } else if (!options.sharp_depths.empty()) {
    asked.sharp_depths = sharp_depths(options.sharp_depths, asked.lens, scene.camera.fov_y_degrees,
                                      drawn_size(options).height, asked.coc_scale);
  } else {
    check_lens(asked.lens, options.lens, options.scene);
  }
  return asked;
}

}  // namespace

Shot asked_shot(const RenderOptions& options, const Scene& scene, FrameSequence& sequence) {
  if (!can_look(scene.camera, options.frame)) {
    throw UsageError("frame " + short_number(options.frame) + ": the camera of '" + options.scene +
                     "' stands at its target or looks along its upward axis; other keys of its "
                     "position or target would be right");
  }
  const bool is_of_frames = checked_effect_of_frames(options, scene).has_value();
  if (options.samples_are_given && options.samples > 1 && has_sample_rows(scene) &&
      drawn_size(options).height * options.samples > kMaxImageSize) {
    throw UsageError(
        "--multisample: materials with shaders, and more than a million and a half triangles, are "
        "drawn with a row for each sample, and " +
        std::to_string(kMaxImageSize) + " rows are the most; give a smaller --size");
  }
  Shot shot{.scene = &scene,
            .frame = options.frame,
            .width = options.size.width,
            .height = options.size.height,
            .supersample = options.supersample,
            .samples = is_of_frames ? 1 : options.samples,
            .show = options.show,
            .method = options.method,
            .arithmetic = options.arithmetic,
            .layers = options.layers,
            .sampling = with_shutter_of(scene, options.sampling),
            .shard = options.shard,
            .goal = options.goal,
            .verify = options.verify,
            .most_coc_px = options.max_coc_px,
            .effects = effects_on(options, scene),
            .sequence = &sequence,
            .profile = options.profile};
  if (options.show == Show::coc || has_depth_of_field(options)) {
    shot.lens = asked_lens(options, scene);
  }
  return shot;
}

void refuse_lens(const LensError& error, const RenderOptions& options) {
  std::string where = options.scene;
  if (options.autofocus) {
    const glm::ivec2 at = *error.lens.focus_at;
    where = "--autofocus " + std::to_string(at.x) + "," + std::to_string(at.y);
  }
  if (options.sharp_depths.empty()) check_lens(error.lens.lens, options.lens, where);
  check_pixel_coc(error.lens.settings.coc);
  check_arithmetic(options.arithmetic, error.lens.settings);
  throw UsageError(error.what());
}

FrameSequence frame_sequence(const RenderOptions& options) {
  if (!options.sequence.frames) return {options.frame, 1.0};
  return {static_cast<double>(options.sequence.frames->first),
          static_cast<double>(options.sequence.frames->step)};
}

std::optional<ChosenEffect> checked_effect_of_frames(const RenderOptions& options,
                                                     const Scene& scene) {
  const std::string where =
      options.effects.are_given ? "--effect" : "the scene '" + options.scene + "'";
  auto effect = effect_of_frames(effects_on(options, scene), where);
  if (!effect) return {};
  const std::string name = where + ": " + std::string{effect->effect->name};
  if (options.gl != nullptr) {
    throw UsageError(name + " draws its frames in the emulation; leave out --gl");
  }
  if (options.samples_are_given && options.samples > 1) {
    throw UsageError(name +
                     " makes the picture of frames that have no edges; leave out --multisample");
  }
  if (options.show == Show::image && options.method.filter == nullptr) {
    throw UsageError(name + " makes the picture that a method filters, and --method " +
                     std::string{options.method.name()} +
                     " draws the scene itself; give a method of a picture, or pinhole");
  }
  return effect;
}

}  // namespace softfocus

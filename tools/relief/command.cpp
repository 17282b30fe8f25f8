// softfocus relief: relief textures made, shown and warped to new views; impostors timed.

#include <algorithm>
#include <array>
#include <iostream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/draw/draw_scene.h"
#include "scenes/load/load_scene.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/cli/platform.h"
#include "tools/files/whole_file.h"
#include "tools/relief/relief_file.h"
#include "tools/relief/relief_options.h"
#include "tools/sequence/frame_names.h"

namespace softfocus {
namespace {

void check_output(const ReliefOptions& options) {
  if (options.output == "-") {
    if (is_terminal(kStandardOutput)) {
      throw UsageError("-o -: standard output is a terminal; send it to a file or a program");
    }
    return;
  }
  check_writable(options.output);
  if (options.height_field) {
    check_not_read("-o", options.output,
                   {{options.input, "the heights"}, {options.colour, "--colour"}});
  } else if (options.action != "make" && options.action != "box") {
    check_not_read("-o", options.output, {{options.input, "the relief"}});
  }
}

int make(const ReliefOptions& options) {
  if (options.output.empty()) throw UsageError("-o is missing: give a file for the relief");
  check_output(options);
  return make_relief_file(options);
}

int box(const ReliefOptions& options) {
  if (options.part == ReliefPart::depth || options.part == ReliefPart::normals) {
    throw UsageError("--show: box shows image, faces or unseen");
  }
  const std::optional<NumberedName> name = numbered_name("-o", options.output);
  if (name) {
    check_writable(name_at(*name, 0));
  } else {
    check_output(options);
  }
  return show_box(options);
}

int show(const ReliefOptions& options) {
  check_output(options);
  return show_relief(options);
}

int warp(const ReliefOptions& options) {
  check_output(options);
  return warp_view(options);
}

struct ReliefAction {
  std::string_view name;
  int (*work)(const ReliefOptions&);
  bool writes_picture;
  /// Options that it reads beside those of all.
  std::array<std::string_view, 37> options;
};
constexpr std::array kReliefActions{
    ReliefAction{"make",
                 make,
                 false,
                 {"-o", "--scene-path", "--frame", "--texels", "--depth-bits", "--normals",
                  "--unlit", "--yaw", "--pitch", "--projection", "--height-field", "--colour",
                  "--height", "--empty", "--traced"}},
    ReliefAction{"show", show, true, {"-o", "--format", "--show"}},
    ReliefAction{"warp",
                 warp,
                 true,
                 {"-o", "--format", "--size", "--yaw", "--pitch", "--distance", "--resampling",
                  "--fixed", "--join", "--light"}},
    ReliefAction{"box",
                 box,
                 true,
                 {"-o", "--format", "--scene-path", "--frame", "--size", "--texels", "--depth-bits",
                  "--normals", "--yaw", "--pitch", "--distance", "--show", "--resampling",
                  "--fixed", "--join", "--slices", "--bisections"}},
    ReliefAction{"bench",
                 bench_relief,
                 false,
                 {"--size", "--yaw", "--pitch", "--distance", "--runs", "--json"}},
    ReliefAction{"turn",
                 turn_impostor,
                 false,
                 {"-o",
                  "--scene-path",
                  "--frame",
                  "--size",
                  "--depth-bits",
                  "--resampling",
                  "--fixed",
                  "--frames",
                  "--every",
                  "--tolerance",
                  "--texels-per-pixel",
                  "--no-sprites",
                  "--zoom",
                  "--regions",
                  "--join",
                  "--turns",
                  "--cache",
                  "--schedule",
                  "--aside",
                  "--update-frames",
                  "--slice-ms",
                  "--predict",
                  "--moving-light",
                  "--approach",
                  "--levels",
                  "--rival",
                  "--views",
                  "--hemisphere",
                  "--parallax",
                  "--projection",
                  "--box",
                  "--slices",
                  "--bisections",
                  "--traced",
                  "--light-pixels",
                  "--texels",
                  "--json"}},
    ReliefAction{"walk",
                 walk_scene,
                 false,
                 {"-o", "--scene-path", "--frame", "--size", "--frames", "--every", "--json"}}};

/// An option that another action reads and this one does not.
void check_read(const CLI::App& parser, const ReliefAction& action) {
  for (const ReliefAction& other : kReliefActions) {
    for (const std::string_view name : other.options) {
      const bool reads =
          std::find(action.options.begin(), action.options.end(), name) != action.options.end();
      if (!reads && is_given(parser, std::string{name})) {
        throw UsageError(std::string{name} + ": relief " + std::string{action.name} +
                         " does not read it");
      }
    }
  }
}

/// Options of work aside need a schedule that has some.
void check_schedule(const CLI::App& parser, const ReliefOptions& options) {
  const bool is_sliced = options.schedule == TurnSchedule::slices;
  if (!is_sliced && options.schedule != TurnSchedule::own_thread) {
    for (const char* name : {"--aside", "--update-frames"}) {
      if (is_given(parser, name)) {
        throw UsageError(std::string{name} + " needs --schedule slices or own-thread");
      }
    }
  }
  if (options.warps_aside && (options.moving_light || options.levels > 1)) {
    throw UsageError("--aside warps has neither --moving-light nor --levels; renewals has");
  }
  if (is_given(parser, "--slice-ms") && (!is_sliced || options.update_frames > 0)) {
    throw UsageError("--slice-ms needs --schedule slices, without --update-frames");
  }
}

/// Options of make: those that read a scene, and those that read heights.
constexpr std::array<std::string_view, 8> kOfScene{"--scene-path", "--frame", "--texels",
                                                   "--yaw",        "--pitch", "--projection",
                                                   "--traced",     "--unlit"};
constexpr std::array<std::string_view, 3> kOfHeights{"--colour", "--height", "--empty"};

constexpr std::array<std::string_view, 3> kWarpOptions{"--resampling", "--fixed", "--join"};

void check_pairs(const CLI::App& parser, const ReliefOptions& options) {
  for (const std::string_view name : kOfScene) {
    if (options.height_field && is_given(parser, std::string{name})) {
      throw UsageError(std::string{name} + ": --height-field does not read it");
    }
  }
  for (const std::string_view name : kOfHeights) {
    if (!options.height_field && is_given(parser, std::string{name})) {
      throw UsageError(std::string{name} + ": is of a height field; give --height-field too");
    }
  }
  if (options.action == "turn" && !options.box) {
    if (is_given(parser, "--texels")) {
      throw UsageError("--texels: an impostor has as many as the view needs; it is of turn --box");
    }
    if (options.slices > 0) throw UsageError("--slices: six faces have them; give --box too");
  }
  if (options.slices == 0 && is_given(parser, "--bisections")) {
    throw UsageError("--bisections: they follow slices; give --slices too");
  }
  for (const std::string_view name : kWarpOptions) {
    if (options.slices > 0 && is_given(parser, std::string{name})) {
      throw UsageError(std::string{name} + ": --slices warps nothing");
    }
  }
  if (options.lights_pixels && !options.moving_light) {
    throw UsageError("--light-pixels: lights pixels anew each frame; give --moving-light too");
  }
}

/// Options of turn: only an atlas reads these, and only an impostor these.
constexpr std::array<std::string_view, 3> kAtlasOptions{"--views", "--hemisphere", "--parallax"};
constexpr std::array<std::string_view, 16> kImpostorOptions{
    "--tolerance", "--no-sprites", "--regions", "--turns",        "--cache",         "--schedule",
    "--aside",     "--slice-ms",   "--predict", "--moving-light", "--update-frames", "--approach",
    "--levels",    "--projection", "--traced",  "--light-pixels"};

void check_turn(const CLI::App& parser, const ReliefOptions& options) {
  if (options.rival && options.box) {
    throw UsageError("--box: is no octahedral atlas; give --rival or --box");
  }
  for (const std::string_view name : kAtlasOptions) {
    if (!options.rival && is_given(parser, std::string{name})) {
      throw UsageError(std::string{name} + ": only relief turn --rival octahedral reads it");
    }
  }
  for (const std::string_view name : kWarpOptions) {
    if (options.rival && is_given(parser, std::string{name})) {
      throw UsageError(std::string{name} + ": an octahedral atlas does not read it");
    }
  }
  if (options.box && is_given(parser, "--texels-per-pixel")) {
    throw UsageError("--texels-per-pixel: six faces do not read it; --texels would be right");
  }
  if (!options.rival && !options.box) return;
  for (const std::string_view name : kImpostorOptions) {
    if (is_given(parser, std::string{name})) {
      throw UsageError(std::string{name} + (options.box
                                                ? ": six faces do not read it"
                                                : ": an octahedral atlas does not read it"));
    }
  }
}

int run_relief(const CLI::App& parser, ReliefOptions& options) {
  for (const ReliefAction& action : kReliefActions) {
    if (action.name != options.action) continue;
    check_read(parser, action);
    check_schedule(parser, options);
    check_pairs(parser, options);
    check_turn(parser, options);
    const bool is_box_files = action.work == box && numbered_name("-o", options.output);
    if (action.writes_picture && !is_box_files)
      settle_format(parser, options.output, options.format);
    return action.work(options);
  }
  refuse_name("ACTION", options.action, names_in(kReliefActions));
}

}  // namespace

void write_relief_output(const std::string& output, std::span<const std::byte> bytes) {
  if (output == "-") {
    write_to_standard_output(bytes);
    return;
  }
  WholeFile file{output};
  file.write(bytes);
  file.commit();
}

WarpRule warp_rule(const ReliefOptions& options) {
  return {options.resampling, options.fixed ? PlaceNumbers::fixed : PlaceNumbers::floats,
          options.join_texels};
}

BoxRule box_rule(const ReliefOptions& options) {
  BoxRule rule{.warp = warp_rule(options)};
  if (options.slices > 0) rule.march = MarchSettings{options.slices, options.bisections};
  return rule;
}

Scene relief_scene(const ReliefOptions& options) {
  Scene scene = load_scene(options.input, scene_search_path(options.scene_path));
  std::vector<ReadFile> inputs;
  inputs.reserve(scene.files.size());
  for (const auto& file : scene.files) inputs.push_back({file, "a file of the scene"});
  if (!options.output.empty() && options.output != "-") {
    check_not_read("-o", options.output, inputs);
  }
  print_scene_warnings(scene.warnings, false);
  if (triangle_count(scene) == 0) {
    throw UsageError("'" + options.input + "' has no triangles; a relief needs some");
  }
  if (has_transparent(scene)) {
    warn("a relief has one surface a texel: transparent ones are left out");
  }
  return scene;
}

Command add_relief_command(CLI::App& program) {
  CLI::App* parser =
      add_command(program, "relief", "Make, show and warp relief textures; time impostors");
  const auto options = std::make_shared<ReliefOptions>();
  add_argument(
      *parser, "ACTION",
      "make a scene's relief; show or warp a relief's file; box: a scene as six reliefs; bench a "
      "file's warps; turn around a scene as an impostor; walk with a scene's camera among its "
      "impostors",
      options->action);
  offer(*parser, "ACTION", [] { return names_in(kReliefActions); });
  add_argument(*parser, "INPUT",
               "A scene or heights for make, a scene for box, turn and walk, else a relief's file",
               options->input);
  add_relief_options(*parser, options);
  return {parser, [parser, options] { return run_relief(*parser, *options); }};
}

}  // namespace softfocus

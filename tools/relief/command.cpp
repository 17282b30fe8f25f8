// softfocus relief: relief textures made, shown and warped to new views; impostors timed.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "raster/images/texel.h"
#include "scenes/draw/surface_draws.h"
#include "scenes/load/load_scene.h"
#include "scenes/relief/light_relief.h"
#include "scenes/relief/octahedral_atlas.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/cli/platform.h"
#include "tools/files/same_file.h"
#include "tools/files/whole_file.h"
#include "tools/relief/relief_file.h"
#include "tools/relief/relief_options.h"
#include "tools/sequence/frame_names.h"

namespace softfocus {
namespace {

struct NamedPart {
  std::string_view name;
  ReliefPart part;
};
constexpr std::array kReliefParts{
    NamedPart{"image", ReliefPart::image}, NamedPart{"depth", ReliefPart::depth},
    NamedPart{"normals", ReliefPart::normals}, NamedPart{"faces", ReliefPart::faces},
    NamedPart{"unseen", ReliefPart::unseen}};

struct NamedTurnSchedule {
  std::string_view name;
  TurnSchedule schedule;
};
constexpr std::array kTurnSchedules{NamedTurnSchedule{"serial", TurnSchedule::serial},
                                    NamedTurnSchedule{"split", TurnSchedule::split},
                                    NamedTurnSchedule{"slices", TurnSchedule::slices},
                                    NamedTurnSchedule{"own-thread", TurnSchedule::own_thread}};

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
  std::array<std::string_view, 32> options;
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
                  "--fixed", "--join"}},
    ReliefAction{
        "bench", bench_relief, false, {"--size", "--yaw", "--pitch", "--distance", "--runs"}},
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
                  "--texels"}}};

constexpr std::array<std::string_view, 46> kReliefOptions{"-o",
                                                          "--format",
                                                          "--scene-path",
                                                          "--frame",
                                                          "--size",
                                                          "--texels",
                                                          "--depth-bits",
                                                          "--normals",
                                                          "--yaw",
                                                          "--pitch",
                                                          "--distance",
                                                          "--show",
                                                          "--resampling",
                                                          "--fixed",
                                                          "--frames",
                                                          "--every",
                                                          "--tolerance",
                                                          "--texels-per-pixel",
                                                          "--no-sprites",
                                                          "--zoom",
                                                          "--runs",
                                                          "--regions",
                                                          "--join",
                                                          "--turns",
                                                          "--cache",
                                                          "--schedule",
                                                          "--aside",
                                                          "--update-frames",
                                                          "--slice-ms",
                                                          "--predict",
                                                          "--unlit",
                                                          "--light",
                                                          "--moving-light",
                                                          "--approach",
                                                          "--levels",
                                                          "--rival",
                                                          "--views",
                                                          "--hemisphere",
                                                          "--parallax",
                                                          "--projection",
                                                          "--height-field",
                                                          "--colour",
                                                          "--height",
                                                          "--empty",
                                                          "--box",
                                                          "--traced"};

/// X,Y,Z that are not all next to 0: squares of these are no subnormals.
glm::vec3 parse_towards(const std::string& text) {
  glm::vec3 towards{0.0f};
  std::size_t begin = 0;
  for (int i = 0; i < 3; ++i) {
    const std::size_t end = i < 2 ? text.find(',', begin) : text.size();
    if (end == std::string::npos) break;
    towards[i] = static_cast<float>(parse_number("--light", text.substr(begin, end - begin), -1e6,
                                                 1e6, "three numbers such as 1,2,3"));
    begin = end + 1;
    const float largest =
        std::max({std::fabs(towards.x), std::fabs(towards.y), std::fabs(towards.z)});
    if (i == 2 && largest >= 1e-6f) return towards;
  }
  throw UsageError("--light '" + text +
                   "': give three numbers such as 1,2,3, one of them 0.000001 or more from 0");
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

/// Of options of make: those that read a scene, and those that read heights.
constexpr std::array<std::string_view, 8> kOfScene{"--scene-path", "--frame", "--texels",
                                                   "--yaw",        "--pitch", "--projection",
                                                   "--traced",     "--unlit"};
constexpr std::array<std::string_view, 3> kOfHeights{"--colour", "--height", "--empty"};

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
  if (options.action == "turn" && !options.box && is_given(parser, "--texels")) {
    throw UsageError("--texels: an impostor has as many as the view needs; it is of turn --box");
  }
}

/// Of turn: what only an atlas reads, what only an impostor does, and what an atlas does not.
constexpr std::array<std::string_view, 3> kAtlasOptions{"--views", "--hemisphere", "--parallax"};
constexpr std::array<std::string_view, 14> kImpostorOptions{
    "--tolerance",     "--no-sprites", "--regions",  "--turns",     "--cache",
    "--schedule",      "--aside",      "--slice-ms", "--predict",   "--moving-light",
    "--update-frames", "--approach",   "--levels",   "--projection"};
constexpr std::array<std::string_view, 3> kWarpOptions{"--resampling", "--fixed", "--join"};

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
    for (const std::string_view name : kReliefOptions) {
      const bool reads =
          std::find(action.options.begin(), action.options.end(), name) != action.options.end();
      if (!reads && is_given(parser, std::string{name})) {
        throw UsageError(std::string{name} + ": relief " + options.action + " does not read it");
      }
    }
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
    std::cerr << "softfocus: warning: a relief has one surface a texel: transparent ones are left "
                 "out\n";
  }
  return scene;
}

Command add_relief_command(CLI::App& program) {
  CLI::App* parser =
      add_command(program, "relief", "Make, show and warp relief textures; time impostors");
  const auto options = std::make_shared<ReliefOptions>();
  const auto number = [&](const char* name, const char* type, const char* help, double least,
                          double most, const char* wanted, double ReliefOptions::*value) {
    add_value(*parser, name, type, help, [=](const std::string& text) {
      (*options).*value = parse_number(name, text, least, most, wanted);
    });
  };
  const auto whole = [&](const char* name, const char* help, int least, int most,
                         const char* wanted, int ReliefOptions::*value) {
    add_value(*parser, name, "N", help, [=](const std::string& text) {
      (*options).*value = parse_whole(name, text, least, most, wanted);
    });
  };
  add_argument(
      *parser, "ACTION",
      "make a scene's relief; show or warp a relief's file; box: a scene as six reliefs; bench a "
      "file's warps; turn around a scene as an impostor",
      options->action);
  offer(*parser, "ACTION", [] { return names_in(kReliefActions); });
  add_argument(*parser, "INPUT",
               "A scene or heights for make, a scene for box and turn, else a relief's file",
               options->input);
  begin_group(*parser, "Relief");
  add_value(*parser, "--texels", "WxH", "Texels of the relief, 4 to 4096 a side (default: 256x256)",
            [options](const std::string& text) {
              options->texels = parse_size("--texels", text);
              for (const int side : {options->texels.width, options->texels.height}) {
                if (side < 4 || side > kMostReliefSize) {
                  throw UsageError("--texels '" + text + "': each side has 4 to 4096 texels");
                }
              }
            });
  add_value(*parser, "--depth-bits", "8|16", "Bits of a depth (default: 8)",
            [options](const std::string& text) {
              if (text != "8" && text != "16") {
                throw UsageError("--depth-bits '" + text + "': give 8 or 16");
              }
              options->depth_bits = text == "8" ? 8 : 16;
            });
  add_value(*parser, "--projection", "NAME",
            "Of the relief's camera: " + names_of(kReliefProjections) + " (default: orthographic)",
            [options](const std::string& text) {
              for (const NamedProjection& choice : kReliefProjections) {
                if (choice.name == text) {
                  options->projection = choice.projection;
                  return;
                }
              }
              refuse_name("--projection", text, names_in(kReliefProjections));
            });
  offer(*parser, "--projection", [] { return names_in(kReliefProjections); });
  add_flag(*parser, "--normals", "Keep normals, too", options->normals);
  add_flag(*parser, "--unlit",
           "Keep unlit colours, normals and materials, so that warp has --light", options->unlit);
  add_flag(*parser, "--traced",
           "By a ray a texel, where Embree is built in; says how it differs from a drawn one",
           options->traced);
  begin_group(*parser, "Height field");
  add_flag(*parser, "--height-field", "make: INPUT is a grey picture of heights, of any kind",
           options->height_field);
  add_value(*parser, "--colour", "FILE", "Its colours, a picture of its size (default: lit white)",
            [options](const std::string& text) { options->colour = text; });
  number("--height", "M",
         "Metres of a height of 1, or of the largest whole number, if the longer side of the field "
         "has one (default: 0.25)",
         1e-6, 1e6, "a number from 0.000001 to 1000000", &ReliefOptions::height_m);
  add_value(*parser, "--empty", "VALUE",
            "Texels of this height are empty, as those are that are transparent or no number",
            [options](const std::string& text) {
              options->empty_height = static_cast<float>(
                  parse_number("--empty", text, -3e38, 3e38, "a number as the file has it"));
            });
  begin_group(*parser, "View");
  number("--yaw", "DEGREES", "The eye goes to the right about the middle (default: 0)", -180.0,
         180.0, "a number from -180 to 180", &ReliefOptions::yaw_degrees);
  number("--pitch", "DEGREES", "And up (default: 0)", -89.0, 89.0, "a number from -89 to 89",
         &ReliefOptions::pitch_degrees);
  number("--distance", "D", "From the middle, in diagonals of the relief's box (default: 2.5)", 0.6,
         1e4, "a number from 0.6 to 10000", &ReliefOptions::distance);
  add_value(*parser, "--light", "X,Y,Z",
            "An unlit relief is lit from there, in white (default: as it was made)",
            [options](const std::string& text) { options->light = parse_towards(text); });
  add_scene_path(*parser, options->scene_path);
  add_size(*parser, options->size);
  add_frame(*parser, options->frame);
  begin_group(*parser, "Output");
  add_value(
      *parser, "-o,--output", "FILE",
      "The relief of make; the picture of show, warp and box; of box, with %d in the name, six "
      "reliefs; of turn, with %d, every "
      "measured frame beside the redrawn one",
      [options](const std::string& text) { options->output = text; });
  add_format_option(*parser, options->format);
  add_value(*parser, "--show", "PART",
            "What of a relief is shown: image, depth or normals; of a box: image, faces or unseen",
            [options](const std::string& text) {
              for (const NamedPart& part : kReliefParts) {
                if (part.name == text) {
                  options->part = part.part;
                  return;
                }
              }
              refuse_name("--show", text, names_in(kReliefParts));
            });
  begin_group(*parser, "Warp");
  add_value(*parser, "--resampling", "NAME",
            "How texels are moved: " + names_of(kResamplings) + " (default: intertwined)",
            [options](const std::string& text) {
              for (const NamedResampling& choice : kResamplings) {
                if (choice.name == text) {
                  options->resampling = choice.resampling;
                  return;
                }
              }
              refuse_name("--resampling", text, names_in(kResamplings));
            });
  offer(*parser, "--resampling", [] { return names_in(kResamplings); });
  add_flag(*parser, "--fixed", "Places in integers of 1/256 texel", options->fixed);
  number("--join", "TEXELS",
         "Neighbours that come farther apart are not joined: a hole stays (default: all are)", 2.0,
         WarpRule::kJoinAll, "a number from 2 to 1000000", &ReliefOptions::join_texels);
  begin_group(*parser, "Turn");
  whole("--turns", "Full turns, 1 to 100 (default: 1)", 1, 100, "a number from 1 to 100",
        &ReliefOptions::turns);
  number("--cache", "MB", "Of stale reliefs that are kept, in millions of bytes (default: 0)", 0.0,
         1e5, "a number from 0 to 100000", &ReliefOptions::cache_mb);
  whole("--frames", "Frames of a full turn, 4 to 10000 (default: 360)", 4, 10000,
        "a number from 4 to 10000", &ReliefOptions::frames);
  whole("--every", "Errors are measured every N frames (default: 10)", 1, 10000,
        "a number from 1 to 10000", &ReliefOptions::every);
  number("--tolerance", "TEXELS", "The critical point's error that renews a relief (default: 8)",
         1.0, 1e4, "a number from 1 to 10000", &ReliefOptions::tolerance);
  whole("--regions", "By the mean of N x N critical points, 1 to 64 (default: 1, the largest step)",
        1, kMostRegions, "a number from 1 to 64", &ReliefOptions::regions);
  number("--texels-per-pixel", "K", "Of a relief when it is drawn (default: 1)", 0.1, 4.0,
         "a number from 0.1 to 4", &ReliefOptions::texels_per_pixel);
  number("--zoom", "Z", "The object so many times as large in the picture (default: 1)", 0.01, 10.0,
         "a number from 0.01 to 10", &ReliefOptions::zoom);
  add_flag(*parser, "--box", "Six faces, drawn once, in place of an impostor", options->box);
  add_flag(*parser, "--moving-light",
           "The scene's lights turn against the eye; reliefs are unlit, and lit each frame",
           options->moving_light);
  number("--approach", "F",
         "In place of a turn the eye comes straight nearer, from F times the distance", 1.0, 100.0,
         "a number from 1 to 100", &ReliefOptions::approach);
  whole("--levels",
        "Reliefs have N resolutions, each half the one before, 1 to 6 (default: 1); the first has "
        "--texels-per-pixel",
        1, kMostReliefLevels, "a number from 1 to 6", &ReliefOptions::levels);
  add_flag(*parser, "--no-sprites", "Warp every frame, whatever Schaufler's test says",
           options->no_sprites);
  begin_group(*parser, "Schedule of a turn");
  add_value(*parser, "--schedule", "NAME",
            "Who works when: " + names_of(kTurnSchedules) +
                " (default: split, in the frame by all threads)",
            [options](const std::string& text) {
              for (const NamedTurnSchedule& choice : kTurnSchedules) {
                if (choice.name == text) {
                  options->schedule = choice.schedule;
                  return;
                }
              }
              refuse_name("--schedule", text, names_in(kTurnSchedules));
            });
  offer(*parser, "--schedule", [] { return names_in(kTurnSchedules); });
  add_value(*parser, "--aside", "renewals|warps",
            "What slices or the own thread do: draw reliefs, or warp them, too (default: renewals)",
            [options](const std::string& text) {
              if (text != "renewals" && text != "warps") {
                throw UsageError("--aside '" + text + "': give renewals or warps");
              }
              options->warps_aside = text == "warps";
            });
  whole("--update-frames",
        "What begins in a frame is shown N frames later, 1 to 64 (default: when it is done)", 1,
        kMostUpdateFrames, "a number from 1 to 64", &ReliefOptions::update_frames);
  number("--slice-ms", "X",
         "Of slices without --update-frames: pieces are done until a frame took so long (default: "
         "2)",
         0.01, 1e4, "a number from 0.01 to 10000", &ReliefOptions::slice_ms);
  add_flag(*parser, "--predict", "Work for the eye that will be, if it goes on as it goes",
           options->predicts);
  begin_group(*parser, "Rival");
  add_value(*parser, "--rival", "octahedral",
            "Turn an octahedral impostor atlas instead of an impostor",
            [options](const std::string& text) {
              if (text != "octahedral") refuse_name("--rival", text, {"octahedral"});
              options->rival = true;
            });
  whole("--views", "Of the atlas, N x N, 2 to 64 (default: 6)", 2, kMostOctahedralViews,
        "a number from 2 to 64", &ReliefOptions::views);
  add_flag(*parser, "--hemisphere", "All views of the atlas are from above", options->hemisphere);
  whole("--parallax", "Steps from the texel that a ray meets to its depth, 0 to 8 (default: 1)", 0,
        kMostParallaxSteps, "a number from 0 to 8", &ReliefOptions::parallax);
  begin_group(*parser, "Run");
  whole("--runs", "bench times each N times, 1 to 1000 (default: 20)", 1, 1000,
        "a number from 1 to 1000", &ReliefOptions::runs);
  add_pool_options(*parser, options->pool, "the pictures are the same");
  return {parser, [parser, options] { return run_relief(*parser, *options); }};
}

}  // namespace softfocus

// softfocus relief: relief textures made, shown and warped to new views; impostors timed.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <span>
#include <string_view>

#include "raster/images/texel.h"
#include "raster/numbers/exact_math.h"
#include "raster/numbers/vector_math.h"
#include "scenes/draw/surface_draws.h"
#include "scenes/load/load_scene.h"
#include "scenes/relief/octahedral_atlas.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/cli/platform.h"
#include "tools/files/same_file.h"
#include "tools/files/whole_file.h"
#include "tools/relief/relief_file.h"
#include "tools/relief/relief_options.h"

namespace softfocus {
namespace {

struct NamedPart {
  std::string_view name;
  ReliefPart part;
};
constexpr std::array kReliefParts{NamedPart{"image", ReliefPart::image},
                                  NamedPart{"depth", ReliefPart::depth},
                                  NamedPart{"normals", ReliefPart::normals}};

/// `v` turned about a unit axis (Rodrigues).
glm::dvec3 turned_about(glm::dvec3 v, glm::dvec3 axis, double degrees) {
  const double cosine = exact_math::cos_degrees(degrees), sine = exact_math::sin_degrees(degrees);
  return v * cosine + cross(axis, v) * sine + axis * (dot(axis, v) * (1.0 - cosine));
}

/// To the right by yaw, then up by pitch: where the eye goes.
glm::dvec3 turned_view(glm::dvec3 towards_eye, glm::dvec3 right, glm::dvec3 up,
                       const ReliefOptions& options) {
  const glm::dvec3 lifted = turned_about(towards_eye, right, -options.pitch_degrees);
  return turned_about(lifted, up, options.yaw_degrees);
}

void write_output(const ReliefOptions& options, std::span<const std::byte> bytes) {
  if (options.output == "-") {
    write_to_standard_output(bytes);
    return;
  }
  WholeFile file{options.output};
  file.write(bytes);
  file.commit();
}

void check_output(const ReliefOptions& options) {
  if (options.output == "-") {
    if (is_terminal(kStandardOutput)) {
      throw UsageError("-o -: standard output is a terminal; send it to a file or a program");
    }
    return;
  }
  check_writable(options.output);
  if (options.action != "make") {
    check_not_read("-o", options.output, {{options.input, "the relief"}});
  }
}

int make(const ReliefOptions& options) {
  if (options.output.empty()) throw UsageError("-o is missing: give a file for the relief");
  check_output(options);
  const Scene scene = relief_scene(options);
  ThreadPool pool{options.pool.threads, options.pool.isa};
  ReliefMaker maker = prepare_relief(scene, options.frame, pool);
  const CameraMatrices camera = camera_matrices(scene.camera, options.frame, 1, 1);
  const glm::dvec3 back = camera.eye - maker.middle;
  const glm::dvec3 up = normalize(scene.camera.up);
  const glm::dvec3 right = normalize(cross(up, back));
  const ReliefView view{maker.middle + turned_view(back, right, up, options), up};
  const ReliefTexture relief = make_relief(
      maker, view,
      {options.texels.width, options.texels.height, options.depth_bits, options.normals}, pool);
  if (!relief_extent(relief)) {
    throw UsageError("'" + scene.name + "': nothing opaque is seen from there");
  }
  write_output(options, encode_relief(relief));
  return kDone;
}

glm::vec3 shown_part(const ReliefTexture& relief, ReliefPart part, std::size_t at) {
  const auto three = [](std::uint32_t packed, const auto& of_byte) {
    return glm::vec3{of_byte(packed & 255u), of_byte(packed >> 8 & 255u),
                     of_byte(packed >> 16 & 255u)};
  };
  if (part == ReliefPart::depth) {
    const auto last = static_cast<float>(last_depth(relief.depth_bits));
    return glm::vec3{1.0f - static_cast<float>(relief.depths[at]) / last};
  }
  if (part == ReliefPart::normals) {
    return three(relief.normals[at], [](std::uint32_t byte) {
      return unorm8_to_linear(static_cast<std::uint8_t>(byte));
    });
  }
  return three(relief.colours[at],
               [](std::uint32_t byte) { return srgb8_to_linear(static_cast<std::uint8_t>(byte)); });
}

int show(const ReliefOptions& options) {
  check_output(options);
  const ReliefTexture relief = read_relief_file(options.input);
  if (options.part == ReliefPart::normals && relief.normals.empty()) {
    throw UsageError("--show normals: '" + options.input +
                     "' has none; softfocus relief make --normals makes a relief that has");
  }
  Image picture = make_image(Format::rgba16f, relief.width, relief.height);
  const std::uint16_t empty = empty_depth(relief.depth_bits);
  const double step_m = depth_step(relief);
  for (int y = 0; y < relief.height; ++y) {
    for (int x = 0; x < relief.width; ++x) {
      const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(relief.width) +
                             static_cast<std::size_t>(x);
      if (relief.depths[at] == empty) continue;
      store_texel<Format::rgba16f>(
          picture, x, y,
          {shown_part(relief, options.part, at), static_cast<float>(relief.depths[at] * step_m)},
          Profile{});
    }
  }
  write_output(options, encode(picture, options.format));
  return kDone;
}

int warp(const ReliefOptions& options) {
  check_output(options);
  const ReliefTexture relief = read_relief_file(options.input);
  const auto [width, height] = options.size;
  const Camera camera = camera_before(relief, options);
  const CameraMatrices matrices = camera_matrices(camera, 0.0, width, height);
  const ReliefExtent extent = *relief_extent(relief);
  const std::optional<PlaneRectangle> place = warped_extent(relief, extent, matrices.eye);
  if (!place) {
    throw UsageError(
        "--yaw, --pitch and --distance: from there the relief is not seen from its "
        "front; smaller angles would be right");
  }
  ThreadPool pool{options.pool.threads, options.pool.isa};
  WarpedRelief warped;
  WarpCounts counts;
  warp_relief(relief, extent, matrices.eye, *place, warp_rule(options), warped, pool, &counts);
  Image picture = make_image(Format::rgba16f, width, height);
  clear_image(picture, {0.0f, 0.0f, 0.0f, 65504.0f}, Profile{});
  map_relief(warped, plane_mapping(relief, matrices, *place, width, height), picture, pool);
  write_output(options, encode(picture, options.format));
  std::fprintf(stderr,
               "%lld texels; %lld pieces, %lld over others, %lld stretched between neighbours more "
               "than %d texels apart\n",
               static_cast<long long>(extent.filled), static_cast<long long>(counts.pieces),
               static_cast<long long>(counts.overlaps), static_cast<long long>(counts.stretched),
               kApart);
  return kDone;
}

struct ReliefAction {
  std::string_view name;
  int (*work)(const ReliefOptions&);
  bool writes_picture;
  /// Options that it reads beside those of all.
  std::array<std::string_view, 21> options;
};
constexpr std::array kReliefActions{
    ReliefAction{"make",
                 make,
                 false,
                 {"-o", "--scene-path", "--frame", "--texels", "--depth-bits", "--normals", "--yaw",
                  "--pitch"}},
    ReliefAction{"show", show, true, {"-o", "--format", "--show"}},
    ReliefAction{"warp",
                 warp,
                 true,
                 {"-o", "--format", "--size", "--yaw", "--pitch", "--distance", "--resampling",
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
                  "--rival",
                  "--views",
                  "--hemisphere",
                  "--parallax"}}};

constexpr std::array<std::string_view, 29> kReliefOptions{
    "-o",           "--format",    "--scene-path",
    "--frame",      "--size",      "--texels",
    "--depth-bits", "--normals",   "--yaw",
    "--pitch",      "--distance",  "--show",
    "--resampling", "--fixed",     "--frames",
    "--every",      "--tolerance", "--texels-per-pixel",
    "--no-sprites", "--zoom",      "--runs",
    "--regions",    "--join",      "--turns",
    "--cache",      "--rival",     "--views",
    "--hemisphere", "--parallax"};

/// Of turn: what only a rival reads, and what only an impostor does.
constexpr std::array<std::string_view, 3> kRivalOptions{"--views", "--hemisphere", "--parallax"};
constexpr std::array<std::string_view, 8> kImpostorOptions{
    "--resampling", "--fixed", "--tolerance", "--no-sprites",
    "--regions",    "--join",  "--turns",     "--cache"};

void check_rival(const CLI::App& parser, const ReliefOptions& options) {
  for (const std::string_view name : kRivalOptions) {
    if (!options.rival && is_given(parser, std::string{name})) {
      throw UsageError(std::string{name} + ": only relief turn --rival octahedral reads it");
    }
  }
  for (const std::string_view name : kImpostorOptions) {
    if (options.rival && is_given(parser, std::string{name})) {
      throw UsageError(std::string{name} + ": an octahedral atlas does not read it");
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
    check_rival(parser, options);
    if (action.writes_picture) settle_format(parser, options.output, options.format);
    return action.work(options);
  }
  refuse_name("ACTION", options.action, names_in(kReliefActions));
}

}  // namespace

WarpRule warp_rule(const ReliefOptions& options) {
  return {options.resampling, options.fixed ? PlaceNumbers::fixed : PlaceNumbers::floats,
          options.join_texels};
}

glm::dvec3 relief_middle(const ReliefTexture& relief) {
  return relief_point(relief, 0.5 * (relief.width - 1), 0.5 * (relief.height - 1),
                      0.5 * last_depth(relief.depth_bits));
}

double relief_diagonal(const ReliefTexture& relief) {
  const glm::dvec3 across =
      relief_point(relief, relief.width - 1, relief.height - 1, last_depth(relief.depth_bits)) -
      relief_point(relief, 0, 0, 0);
  return std::sqrt(dot(across, across));
}

Camera camera_before(const ReliefTexture& relief, const ReliefOptions& options) {
  const glm::dvec3 right = normalize(relief.camera.a), up = normalize(relief.camera.b) * -1.0;
  const double diagonal = relief_diagonal(relief);
  Camera camera;
  camera.target = relief_middle(relief);
  camera.position = camera.target + turned_view(relief.camera.f * -1.0, right, up, options) *
                                        (options.distance * diagonal);
  camera.up = up;
  // The box fills the picture a diagonal and a half away.
  camera.near_m = 1e-3 * diagonal;
  camera.far_m = (options.distance + 2.0) * diagonal;
  return camera;
}

Scene relief_scene(const ReliefOptions& options) {
  Scene scene = load_scene(options.input, scene_search_path(options.scene_path));
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
      "make a scene's relief; show or warp a relief's file; bench its warps; turn around a "
      "scene as an impostor",
      options->action);
  offer(*parser, "ACTION", [] { return names_in(kReliefActions); });
  add_argument(*parser, "INPUT", "A scene for make and turn, else a relief's file", options->input);
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
  add_flag(*parser, "--normals", "Keep normals, too", options->normals);
  begin_group(*parser, "View");
  number("--yaw", "DEGREES", "The eye goes to the right about the middle (default: 0)", -180.0,
         180.0, "a number from -180 to 180", &ReliefOptions::yaw_degrees);
  number("--pitch", "DEGREES", "And up (default: 0)", -89.0, 89.0, "a number from -89 to 89",
         &ReliefOptions::pitch_degrees);
  number("--distance", "D", "From the middle, in diagonals of the relief's box (default: 2.5)", 0.6,
         1e4, "a number from 0.6 to 10000", &ReliefOptions::distance);
  add_scene_path(*parser, options->scene_path);
  add_size(*parser, options->size);
  add_frame(*parser, options->frame);
  begin_group(*parser, "Output");
  add_value(*parser, "-o,--output", "FILE",
            "The relief of make; the picture of show and warp; of turn, with %d in the name, every "
            "measured frame beside the redrawn one",
            [options](const std::string& text) { options->output = text; });
  add_format_option(*parser, options->format);
  add_value(*parser, "--show", "image|depth|normals", "What of a relief is shown",
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
  add_flag(*parser, "--no-sprites", "Warp every frame, whatever Schaufler's test says",
           options->no_sprites);
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

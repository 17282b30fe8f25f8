// The options of softfocus relief, whatever its action reads of them.

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include "scenes/relief/impostors/octahedral_atlas.h"
#include "tools/cli/errors.h"
#include "tools/cli/parser.h"
#include "tools/relief/relief_options.h"

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

}  // namespace

void add_relief_options(CLI::App& parser, const std::shared_ptr<ReliefOptions>& options) {
  const auto number = [&](const char* name, const char* type, const char* help, double least,
                          double most, const char* wanted, double ReliefOptions::*value) {
    add_value(parser, name, type, help, [=](const std::string& text) {
      (*options).*value = parse_number(name, text, least, most, wanted);
    });
  };
  const auto whole = [&](const char* name, const char* help, int least, int most,
                         const char* wanted, int ReliefOptions::*value) {
    add_value(parser, name, "N", help, [=](const std::string& text) {
      (*options).*value = parse_whole(name, text, least, most, wanted);
    });
  };
  const auto choice = [&](const char* name, const char* type, const std::string& help,
                          const auto& table, auto named, auto value) {
    add_value(parser, name, type, help, [=, &table](const std::string& text) {
      for (const auto& entry : table) {
        if (entry.name != text) continue;
        (*options).*value = entry.*named;
        return;
      }
      refuse_name(name, text, names_in(table));
    });
    offer(parser, name, [&table] { return names_in(table); });
  };
  begin_group(parser, "Relief");
  add_value(parser, "--texels", "WxH", "Texels of the relief, 4 to 4096 a side (default: 256x256)",
            [options](const std::string& text) {
              options->texels = parse_size("--texels", text);
              for (const int side : {options->texels.width, options->texels.height}) {
                if (side < 4 || side > kMostReliefSize) {
                  throw UsageError("--texels '" + text + "': each side has 4 to 4096 texels");
                }
              }
            });
  add_value(parser, "--depth-bits", "8|16", "Bits of a depth (default: 8)",
            [options](const std::string& text) {
              if (text != "8" && text != "16") {
                throw UsageError("--depth-bits '" + text + "': give 8 or 16");
              }
              options->depth_bits = text == "8" ? 8 : 16;
            });
  choice("--projection", "NAME",
         "Of the relief's camera: " + names_of(kReliefProjections) + " (default: orthographic)",
         kReliefProjections, &NamedProjection::projection, &ReliefOptions::projection);
  add_flag(parser, "--normals", "Keep normals, too", options->normals);
  add_flag(parser, "--unlit", "Keep unlit colours, normals and materials, so that warp has --light",
           options->unlit);
  add_flag(parser, "--traced",
           "By a ray a texel, where Embree is built in; says how it differs from a drawn one",
           options->traced);
  begin_group(parser, "Height field");
  add_flag(parser, "--height-field", "make: INPUT is a grey picture of heights, of any kind",
           options->height_field);
  add_value(parser, "--colour", "FILE", "Its colours, a picture of its size (default: lit white)",
            [options](const std::string& text) { options->colour = text; });
  number("--height", "M",
         "Metres of a height of 1, or of the largest whole number, if the longer side of the field "
         "has one (default: 0.25)",
         1e-6, 1e6, "a number from 0.000001 to 1000000", &ReliefOptions::height_m);
  add_value(parser, "--empty", "VALUE",
            "Texels of this height are empty, as those are that are transparent or no number",
            [options](const std::string& text) {
              options->empty_height = static_cast<float>(
                  parse_number("--empty", text, -3e38, 3e38, "a number as the file has it"));
            });
  begin_group(parser, "View");
  number("--yaw", "DEGREES", "The eye goes to the right about the middle (default: 0)", -180.0,
         180.0, "a number from -180 to 180", &ReliefOptions::yaw_degrees);
  number("--pitch", "DEGREES", "And up (default: 0)", -89.0, 89.0, "a number from -89 to 89",
         &ReliefOptions::pitch_degrees);
  number("--distance", "D", "From the middle, in diagonals of the relief's box (default: 2.5)", 0.6,
         1e4, "a number from 0.6 to 10000", &ReliefOptions::distance);
  add_value(parser, "--light", "X,Y,Z",
            "An unlit relief is lit from there, in white (default: as it was made)",
            [options](const std::string& text) { options->light = parse_towards(text); });
  add_scene_path(parser, options->scene_path);
  add_size(parser, options->size);
  add_frame(parser, options->frame);
  begin_group(parser, "Output");
  add_value(
      parser, "-o,--output", "FILE",
      "The relief of make; the picture of show, warp and box; of box, with %d in the name, six "
      "reliefs; of turn, with %d, every measured frame beside the redrawn one",
      [options](const std::string& text) { options->output = text; });
  add_format_option(parser, options->format);
  choice("--show", "PART",
         "What of a relief is shown: image, depth or normals; of a box: image, faces or unseen",
         kReliefParts, &NamedPart::part, &ReliefOptions::part);
  begin_group(parser, "Warp");
  choice("--resampling", "NAME",
         "How texels are moved: " + names_of(kResamplings) + " (default: intertwined)",
         kResamplings, &NamedResampling::resampling, &ReliefOptions::resampling);
  add_flag(parser, "--fixed", "Places in integers of 1/256 texel", options->fixed);
  number("--join", "TEXELS",
         "Neighbours that come farther apart are not joined: a hole stays (default: all are)", 2.0,
         WarpRule::kJoinAll, "a number from 2 to 1000000", &ReliefOptions::join_texels);
  begin_group(parser, "Turn");
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
  add_flag(parser, "--box", "Six faces, drawn once, in place of an impostor", options->box);
  add_flag(parser, "--moving-light",
           "The scene's lights turn against the eye; reliefs are unlit, and lit each frame",
           options->moving_light);
  number("--approach", "F",
         "In place of a turn the eye comes straight nearer, from F times the distance", 1.0, 100.0,
         "a number from 1 to 100", &ReliefOptions::approach);
  whole("--levels",
        "Reliefs have N resolutions, each half the one before, 1 to 6 (default: 1); the first has "
        "--texels-per-pixel",
        1, kMostReliefLevels, "a number from 1 to 6", &ReliefOptions::levels);
  add_flag(parser, "--no-sprites", "Warp every frame, whatever Schaufler's test says",
           options->no_sprites);
  begin_group(parser, "Schedule of a turn");
  choice("--schedule", "NAME",
         "Who works when: " + names_of(kTurnSchedules) +
             " (default: split, in the frame by all threads)",
         kTurnSchedules, &NamedTurnSchedule::schedule, &ReliefOptions::schedule);
  add_value(parser, "--aside", "renewals|warps",
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
  add_flag(parser, "--predict", "Work for the eye that will be, if it goes on as it goes",
           options->predicts);
  begin_group(parser, "Rival");
  add_value(parser, "--rival", "octahedral",
            "Turn an octahedral impostor atlas instead of an impostor",
            [options](const std::string& text) {
              if (text != "octahedral") refuse_name("--rival", text, {"octahedral"});
              options->rival = true;
            });
  whole("--views", "Of the atlas, N x N, 2 to 64 (default: 6)", 2, kMostOctahedralViews,
        "a number from 2 to 64", &ReliefOptions::views);
  add_flag(parser, "--hemisphere", "All views of the atlas are from above", options->hemisphere);
  whole("--parallax", "Steps from the texel that a ray meets to its depth, 0 to 8 (default: 1)", 0,
        kMostParallaxSteps, "a number from 0 to 8", &ReliefOptions::parallax);
  begin_group(parser, "Run");
  whole("--runs", "bench times each N times, 1 to 1000 (default: 20)", 1, 1000,
        "a number from 1 to 1000", &ReliefOptions::runs);
  add_pool_options(parser, options->pool, "the pictures are the same");
}

}  // namespace softfocus

#include "tools/chart/options.h"

#include <algorithm>
#include <charconv>
#include <cstdint>

#include "scenes/lens_views/lens_points.h"
#include "scenes/load/load_scene.h"
#include "scenes/load/pipeline_file.h"
#include "tools/chart/record.h"
#include "tools/chart/settings.h"
#include "tools/cli/errors.h"
#include "tools/options/method_options.h"
#include "tools/options/run_options.h"

namespace softfocus {
namespace {

constexpr int kLeastTruthSamples = 128;
constexpr int kMostRounds = 100;

/// Sums of all samples and of the halves (72 bytes a pixel), a group of pictures (64), textures
/// and planes of the methods, and the maps of the measures.
constexpr std::uint64_t kChartBytesPerPixel = 320;
/// Impostors also take 500 pictures of atlases, each a sixteenth of the sheet, of 6 bytes a texel.
constexpr std::uint64_t kAtlasBytesPerPixel = 192;

void check_methods(const ChartOptions& options) {
  const std::vector<std::string> known = options.subject->methods();
  for (const std::string& name : options.methods) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    if (is_pipeline_name(name) && options.subject->through_lens) {
      find_named_method("--methods", name);
      continue;
    }
    refuse_name("--methods", name, known);
  }
}

std::vector<std::string> methods_of_all_subjects() {
  std::vector<std::string> names;
  for (const ChartSubject& subject : chart_subjects()) {
    for (std::string& name : subject.methods()) {
      if (std::find(names.begin(), names.end(), name) == names.end()) {
        names.push_back(std::move(name));
      }
    }
  }
  return names;
}

constexpr std::string_view kRandom = "random:", kTo = "..";

/// More scenes than days have minutes are a slip of the finger.
constexpr std::uint64_t kMostSeeds = 1000;

struct SeedRange {
  std::uint64_t first;
  std::uint64_t last;
};

std::optional<std::uint64_t> seed_of(std::string_view text) {
  std::uint64_t seed = 0;
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, seed);
  if (read.ec != std::errc{} || read.ptr != end) return std::nullopt;
  return seed;
}

/// The range of "random:8..11"; nullopt for a name that has no "..".
std::optional<SeedRange> seed_range(std::string_view name) {
  if (!name.starts_with(kRandom)) return std::nullopt;
  const std::string_view seeds = name.substr(kRandom.size());
  const std::size_t to = seeds.find(kTo);
  if (to == seeds.npos) return std::nullopt;
  const auto first = seed_of(seeds.substr(0, to)), last = seed_of(seeds.substr(to + kTo.size()));
  if (!first || !last || *last < *first || *last - *first >= kMostSeeds) {
    throw UsageError("--scenes '" + std::string{name} +
                     "': give a range of at most 1000 seeds, such as random:64..127");
  }
  return SeedRange{*first, *last};
}

}  // namespace

std::vector<std::string> scene_names(const std::string& text) {
  std::vector<std::string> names;
  for (const std::string& name : listed_names("--scenes", text)) {
    const auto range = seed_range(name);
    if (!range) {
      add_once("--scenes", text, name, names);
      continue;
    }
    for (std::uint64_t i = 0; i <= range->last - range->first; ++i) {
      std::string seed{kRandom};
      seed += std::to_string(range->first + i);
      add_once("--scenes", text, seed, names);
    }
  }
  return names;
}

std::string name_for_files(std::string_view scene) {
  std::string name{scene};
  std::replace(name.begin(), name.end(), ':', '-');
  return name;
}

void add_chart_options(CLI::App& parser, ChartOptions& options) {
  begin_group(parser, "Output");
  add_results_option(parser, options, "the chart");
  begin_group(parser, "What is measured");
  add_value(
      parser, "--of", "SUBJECT",
      "What the pictures are to show: " + names_of(chart_subjects()) + " (default: depth-of-field)",
      [&options](const std::string& text) {
        options.subject = find_chart_subject(text);
        if (options.subject == nullptr) {
          refuse_name("--of", text, names_in(chart_subjects()));
        }
      });
  offer(parser, "--of", [] { return names_in(chart_subjects()); });
  add_value(parser, "--scenes", "A,B,...",
            "Scenes or files, as render takes them, and ranges such as random:64..127 (default: "
            "all that have a file; of other subjects than depth of field a few)",
            [&options](const std::string& text) { options.scenes = scene_names(text); });
  offer(parser, "--scenes", known_scenes);
  add_value(
      parser, "--methods", "A,B,...",
      "Methods beside the pinhole (default: all of the subject; of depth of field all filters, "
      "accumulation, filtered-views, surface-splatting, auto)",
      [&options](const std::string& text) { options.methods = listed_names("--methods", text); });
  offer(parser, "--methods", methods_of_all_subjects);
  add_value(
      parser, "--size", "WxH",
      "Width and height in pixels (default: 1024x1024; 256x256 with --quick)",
      [&options](const std::string& text) { options.given_size = parse_size("--size", text); });
  add_flag(parser, "--quick", "A small size, fewer settings and rounds: under a minute",
           options.quick);
  add_value(parser, "--samples", "N",
            "Of the ground truth, a multiple of 16 from 128 to 65536 (default: 4096; 512 with "
            "--quick; of other subjects 1024 and 256)",
            [&options](const std::string& text) {
              constexpr std::string_view kWanted = "a multiple of 16 from 128 to 65536";
              options.given_samples =
                  parse_whole("--samples", text, kLeastTruthSamples, kMostSamples, kWanted);
              if (*options.given_samples % kTruthSampleStep != 0) {
                throw UsageError("--samples '" + text + "': give " + std::string{kWanted});
              }
            });
  add_value(parser, "--rounds", "N",
            "Times that each is timed, in turn with the others, 0 to 100 (default: 7; 3 with "
            "--quick); 0: errors alone",
            [&options](const std::string& text) {
              options.given_rounds =
                  parse_whole("--rounds", text, 0, kMostRounds, "a number from 0 to 100");
            });
  add_frame(parser, options.frame);
  add_scene_path(parser, options.scene_path);
  begin_group(parser, "Run");
  add_pool_options(parser, options.pool, "the pictures are the same");
  add_flag(parser, "--again", "Measure all anew, whatever DIR holds", options.again);
  add_quiet_option(parser, options.quiet);
}

void complete(ChartOptions& options) {
  check_results_option(options, "the chart", "chart");
  const int side = options.quick ? 256 : 1024;
  options.size = options.given_size.value_or(PictureSize{side, side});
  if (options.given_samples && options.subject->truth_of != nullptr) {
    throw UsageError("--samples: the truth of " + std::string{options.subject->name} +
                     " is calculated; leave it out");
  }
  options.truth_samples = options.given_samples.value_or(
      options.quick ? options.subject->quick_truth_samples : options.subject->truth_samples);
  options.rounds = options.given_rounds.value_or(options.quick ? 3 : 7);
  check_methods(options);
  if (options.methods.empty()) options.methods = options.subject->methods();
  // Its frame is the unit of the others' times, its error what they have to better.
  const auto pinhole = std::find(options.methods.begin(), options.methods.end(), kPinhole);
  if (pinhole == options.methods.end()) options.methods.emplace(options.methods.begin(), kPinhole);
  if (options.scenes.empty()) options.scenes = options.subject->scenes;
  if (options.scenes.empty()) {
    for (const SceneListing& scene : list_scenes(scene_search_path(options.scene_path))) {
      options.scenes.push_back(scene.name);
    }
  }
  if (options.scenes.empty()) {
    throw UsageError(
        "no scenes were found; give --scenes with a .toml, .glb, .obj, .ply or .stl file");
  }
  check_memory("--size", options.size,
               kChartBytesPerPixel + (options.subject->turns ? kAtlasBytesPerPixel : 0));
}

}  // namespace softfocus

#include "tools/chart/options.h"

#include <algorithm>

#include "scenes/lens_views/lens_points.h"
#include "scenes/load/load_scene.h"
#include "tools/chart/settings.h"
#include "tools/chart/truth.h"
#include "tools/cli/errors.h"
#include "tools/options/run_options.h"

namespace softfocus {
namespace {

constexpr int kLeastTruthSamples = 128;
constexpr int kMostRounds = 100;

/// Sums of all samples and of the halves (72 bytes a pixel), a group of pictures (64), textures
/// and planes of the methods, and the maps of the measures.
constexpr std::uint64_t kChartBytesPerPixel = 320;

/// The parts of "a,b,c". Throws UsageError for an empty or a repeated one.
std::vector<std::string> parts_of(const std::string& option, const std::string& text) {
  std::vector<std::string> parts;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    parts.push_back(text.substr(start, end - start));
    start = end + 1;
    if (parts.back().empty()) {
      throw UsageError(option + " '" + text + "': give names with a comma between two");
    }
    if (std::count(parts.begin(), parts.end(), parts.back()) > 1) {
      throw UsageError(option + " '" + text + "': '" + parts.back() + "' stands there twice");
    }
  }
  return parts;
}

std::vector<std::string> known_methods(const std::string& text) {
  const std::vector<std::string> known = chart_methods();
  const std::vector<std::string> wanted = parts_of("--methods", text);
  for (const std::string& name : wanted) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    std::string list;
    for (const std::string& one : known) list += (list.empty() ? "" : ", ") + one;
    throw UsageError("--methods '" + name + "': there are " + list);
  }
  return wanted;
}

}  // namespace

void add_chart_options(CLI::App& parser, ChartOptions& options) {
  add_value(parser, "-o,--output", "DIR", "Where the chart and what was measured go; required",
            [&options](const std::string& text) { options.directory = text; });
  add_value(parser, "--scenes", "A,B,...", "Scenes or files, as render takes them (default: all)",
            [&options](const std::string& text) { options.scenes = parts_of("--scenes", text); });
  add_value(parser, "--methods", "A,B,...", "Methods (default: all filters, accumulation, auto)",
            [&options](const std::string& text) { options.methods = known_methods(text); });
  add_value(
      parser, "--size", "WxH",
      "Width and height in pixels (default: 1024x1024; 256x256 with --quick)",
      [&options](const std::string& text) { options.given_size = parse_size("--size", text); });
  add_flag(parser, "--quick", "A small size, fewer settings and rounds: under a minute",
           options.quick);
  add_value(parser, "--samples", "N",
            "Of the ground truth, a multiple of 16 from 128 to 65536 (default: 4096; 512 with "
            "--quick)",
            [&options](const std::string& text) {
              constexpr std::string_view kWanted = "a multiple of 16 from 128 to 65536";
              options.given_samples =
                  parse_whole("--samples", text, kLeastTruthSamples, kMostSamples, kWanted);
              if (*options.given_samples % kTruthSampleStep != 0) {
                throw UsageError("--samples '" + text + "': give " + std::string{kWanted});
              }
            });
  add_value(parser, "--rounds", "N",
            "Times that each is timed, in turn with the others, 1 to 100 (default: 7; 3 with "
            "--quick)",
            [&options](const std::string& text) {
              options.given_rounds =
                  parse_whole("--rounds", text, 1, kMostRounds, "a number from 1 to 100");
            });
  add_frame(parser, options.frame);
  add_scene_path(parser, options.scene_path);
  add_pool_options(parser, options.pool, "the pictures are the same");
  add_flag(parser, "--again", "Measure all anew, whatever DIR holds", options.again);
}

void complete(ChartOptions& options) {
  if (options.directory.empty()) {
    throw UsageError("-o is missing; give a directory for the chart, such as -o chart");
  }
  const int side = options.quick ? 256 : 1024;
  options.size = options.given_size.value_or(PictureSize{side, side});
  options.truth_samples = options.given_samples.value_or(options.quick ? 512 : 4096);
  options.rounds = options.given_rounds.value_or(options.quick ? 3 : 7);
  if (options.methods.empty()) options.methods = chart_methods();
  if (options.scenes.empty()) {
    for (const SceneListing& scene : list_scenes(scene_search_path(options.scene_path))) {
      options.scenes.push_back(scene.name);
    }
  }
  if (options.scenes.empty()) {
    throw UsageError("no scenes were found; give --scenes with a .toml or .obj file");
  }
  check_memory("--size", options.size, kChartBytesPerPixel);
}

}  // namespace softfocus

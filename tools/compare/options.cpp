#include "tools/compare/options.h"

#include <cmath>

#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"
#include "tools/files/whole_file.h"
#include "tools/options/parameter_options.h"
#include "tools/pictures/image_file.h"
#include "tools/pictures/picture_notes.h"

namespace softfocus {

bool counts_pixels(const Tolerance& tolerance) {
  return tolerance.max_pixels || tolerance.max_difference || tolerance.search_px;
}

bool has_limits(const Tolerance& tolerance) {
  return tolerance.max_half_ulps || tolerance.max_flip || tolerance.max_error ||
         counts_pixels(tolerance);
}

std::vector<LimitFinding> check_limits(const Tolerance& tolerance, const Difference& difference,
                                       std::optional<double> flip,
                                       std::optional<std::uint64_t> pixels_beyond) {
  std::vector<LimitFinding> findings;
  if (tolerance.max_half_ulps) {
    findings.push_back({"--max-ulps", " half-ULPs", static_cast<double>(*tolerance.max_half_ulps),
                        static_cast<double>(difference.max_ulp)});
  }
  if (tolerance.max_flip) findings.push_back({"--max-flip", "", *tolerance.max_flip, flip.value()});
  if (tolerance.max_error) {
    findings.push_back({"--max-error", "", *tolerance.max_error, difference.max_error});
  }
  if (counts_pixels(tolerance)) {
    const double most = tolerance.max_pixels.value_or(0.0);
    const std::uint64_t all = difference.values / 4;
    findings.push_back(
        {"--max-pixels", " pixels",
         tolerance.is_percent ? std::floor(most * static_cast<double>(all) / 100.0) : most,
         static_cast<double>(pixels_beyond.value())});
  }
  return findings;
}

std::string limit_text(const LimitFinding& finding) {
  const auto text = [](double value) {
    return std::isinf(value) ? std::string{"infinity"} : short_number(value);
  };
  const std::string away = text(std::fabs(finding.value - finding.limit));
  return finding.option + " " + short_number(finding.limit) + ": " +
         (is_kept(finding) ? "kept, " + away + " below" : "broken by " + away) + ", at " +
         text(finding.value) + finding.unit;
}

namespace {

// clang-format off
constexpr Parameter
    kPixelsPerDegree{"pixels-per-degree", "Of the viewer's sight, for FLIP",
        1.0, 500.0, 67.0206, "", "N"},
    kMaxUlps{"max-ulps", "Tolerance: status 0 up to so many half-ULPs between any two values",
        0, 65535, 0, "half-ULPs", "N", "", 1},
    kMaxFlip{"max-flip", "Tolerance: status 0 up to this mean FLIP", 0.0, 1.0, 0.0, "", "E"},
    kMaxError{"max-error",
        "Tolerance: status 0 up to this difference of any red, green or blue, in linear light",
        0.0, 1e6, 0.0, "", "E"},
    kMaxDifference{"max-difference",
        "Of --max-pixels: of any red, green or blue, in linear light",
        0.0, 1e6, 0.0, "", "D"},
    kSearch{"search",
        "Of --max-pixels: how near a pixel may lie in the other picture, for edges that moved",
        0, 8, 0, "px", "PIXELS", "", 1},
    kThreshold{"threshold",
        "Count as pixelmatch, odiff, idiff and ImageMagick do too, in codes of 8 bits: pixels that "
        "differ by more than this in YIQ; pixelmatch's 0.1",
        0.0, 1.0, kUsualThreshold, "", "T"},
    kPoint{"point",
        "The pictures are of one bright point on black: compare light and shape with the disc of "
        "this radius",
        0.1, 16384.0, 1.0, "px", "PIXELS"};
// clang-format on

void add_map(CLI::App& parser, const std::string& name, const std::string& help,
             std::optional<std::string>& file) {
  add_value(parser, name, "OUT", help, [name, &file](const std::string& text) {
    if (!format_by_extension(text)) {
      throw UsageError(name + " '" + text +
                       "': the name must end in .png, .exr, .tiff, .pfm, .hdr or .npy");
    }
    file = text;
  });
}

/// N or N%.
void read_max_pixels(const std::string& text, Tolerance& tolerance) {
  constexpr const char* kWanted = "a number of pixels, or of percent as 0.1%";
  tolerance.is_percent = text.ends_with('%');
  tolerance.max_pixels =
      tolerance.is_percent
          ? parse_number("--max-pixels", text.substr(0, text.size() - 1), 0.0, 100.0, kWanted)
          : parse_whole("--max-pixels", text, 0, 1 << 30, kWanted);
}

void add_frames(CLI::App& parser, const std::string& name, const std::string& help,
                std::vector<std::string>& files) {
  add_value_list(parser, name, "FRAME", help,
                 [&files](const std::vector<std::string>& names) { files = names; });
}

/// The first of the options for --regions that was given, or none.
std::string for_regions(const CompareOptions& options) {
  if (options.depth_file) return "--depth";
  if (options.scene) return "--scene";
  if (options.fov_y_degrees) return "--fov";
  for (const LensNumber& number : kLensNumbers) {
    if (options.lens.given[number.place]) return "--" + std::string{number.parameter.name};
  }
  if (options.lens.coc_scale) return "--coc-scale";
  return "";
}

void check_sequences(const CompareOptions& options) {
  if (options.frames.empty())
    throw UsageError("--against needs --flicker with the frames to judge");
  if (options.truth.empty()) {
    throw UsageError("--flicker needs --against with the same frames of the ground truth");
  }
  if (!options.first.empty() || options.regions || options.point_radius_px ||
      options.flip_map_file || options.ulp_map_file || options.measures.hdr_flip ||
      options.code_threshold || has_limits(options.tolerance)) {
    throw UsageError(
        "--flicker compares two sequences; leave out A, B, --diff, --diff-ulps, --regions, "
        "--hdr, --threshold, --point, --max-ulps, --max-flip, --max-error and --max-pixels");
  }
  if (options.frames.size() != options.truth.size()) {
    throw UsageError("--flicker has " + std::to_string(options.frames.size()) +
                     " frames and --against " + std::to_string(options.truth.size()) +
                     "; give as many");
  }
  if (options.frames.size() < 2) throw UsageError("--flicker needs two frames or more");
}

std::vector<ReadFile> compared_files(const CompareOptions& options) {
  std::vector<ReadFile> files;
  const auto add = [&](const std::string& file, const std::string& what) {
    files.push_back({file, what});
    files.push_back({sidecar_of(file), "the sidecar of " + what});
  };
  add(options.first, "A");
  add(options.second, "B");
  if (options.depth_file) add(*options.depth_file, "--depth");
  return files;
}

}  // namespace

void add_compare_options(CLI::App& parser, CompareOptions& options) {
  // check_compare_options() asks for them: with --flicker there are none.
  add_optional_argument(parser, "A", "A picture: .npy, .exr, .pfm, .hdr, .png or .jpg",
                        options.first);
  add_optional_argument(parser, "B", "What it should be: a picture of the same size",
                        options.second);
  begin_group(parser, "Output");
  add_flag(parser, "--json", "Print JSON", options.json);
  add_map(parser, "--diff",
          "Write a map of FLIP, what a viewer sees of the differences: black 0 over purple, red "
          "and orange to pale yellow 1",
          options.flip_map_file);
  add_map(parser, "--diff-ulps",
          "Write a map of differing bits: black equal, blue 1 half-ULP to red 2^15",
          options.ulp_map_file);
  begin_group(parser, "Measures");
  add_parameter(parser, kThreshold, "", options.code_threshold);
  add_flag(parser, "--hdr", "HDR-FLIP too: the largest over all exposures of B",
           options.measures.hdr_flip);
  add_parameter(parser, kPixelsPerDegree, "67.0206, a 4K screen as wide as it is far",
                options.measures.pixels_per_degree);
  begin_group(parser, "Regions");
  add_flag(parser, "--regions",
           "Measure by region too: silhouette band, near field, focus, far field, edges in focus, "
           "by the depth in B's alpha and the lens",
           options.regions);
  add_text(parser, "--depth", "FILE",
           "Picture whose alpha is the depth for --regions (default: B, or A if B has none)",
           options.depth_file);
  add_text(parser, "--scene", "NAME",
           "Scene whose lens and field of view make the regions (default: what B or A carries)",
           options.scene);
  offer(parser, "--scene", known_scenes);
  add_scene_path(parser, options.scene_path);
  add_compared_lens_options(parser, options.lens,
                            [&options](double degrees) { options.fov_y_degrees = degrees; });
  begin_group(parser, "Tolerance");
  add_parameter(parser, kMaxUlps, "", options.tolerance.max_half_ulps);
  add_parameter(parser, kMaxFlip, "", options.tolerance.max_flip);
  add_parameter(parser, kMaxError, "", options.tolerance.max_error);
  add_value(parser, "--max-pixels", "N[%]",
            "Tolerance: status 0 up to so many pixels that differ by more than --max-difference",
            [&options](const std::string& text) { read_max_pixels(text, options.tolerance); });
  add_parameter(parser, kMaxDifference, "0", options.tolerance.max_difference);
  add_parameter(parser, kSearch, "0", options.tolerance.search_px);
  begin_group(parser, "Measures");
  add_parameter(parser, kPoint, "", options.point_radius_px);
  add_frames(parser, "--flicker", "Frames of a sequence, in order, instead of A and B",
             options.frames);
  add_frames(parser, "--against", "The same frames of the ground truth, for --flicker",
             options.truth);
}

void check_maps(const CompareOptions& options, const std::vector<ReadFile>& inputs) {
  if (options.flip_map_file) check_not_read("--diff", *options.flip_map_file, inputs);
  if (options.ulp_map_file) check_not_read("--diff-ulps", *options.ulp_map_file, inputs);
}

void check_compare_options(const CompareOptions& options) {
  const std::string lens_option = for_regions(options);
  if (!options.regions && !lens_option.empty()) {
    throw UsageError(lens_option + " is for --regions; give that too");
  }
  if (!options.frames.empty() || !options.truth.empty()) return check_sequences(options);
  if (options.first.empty()) throw UsageError("A is missing; --help says what to give");
  if (options.second.empty()) throw UsageError("B is missing; --help says what to give");
  check_maps(options, compared_files(options));
  if (options.flip_map_file && options.ulp_map_file &&
      is_same_file(*options.flip_map_file, *options.ulp_map_file)) {
    throw UsageError("--diff and --diff-ulps name the same file; give two");
  }
}

}  // namespace softfocus

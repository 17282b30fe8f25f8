// softfocus compare: how two pictures differ, counted, measured and shown.

#include <memory>
#include <utility>

#include "dof/measure/flicker.h"
#include "dof/measure/heat_map.h"
#include "raster/numbers/half.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"
#include "tools/compare/options.h"
#include "tools/compare/report.h"
#include "tools/files/whole_file.h"
#include "tools/pictures/image_file.h"
#include "tools/pictures/png_text.h"

namespace softfocus {
namespace {

// As diff has it.
constexpr int kEqual = 0;
constexpr int kDifferent = 1;

/// A picture, what its file is called, and what the file says of it.
struct NamedPicture {
  std::string name;
  Picture picture;
  FoundNotes notes;
  bool is_straight = false;  ///< its colours are not multiplied by alpha, an opacity
};

NamedPicture read_named(const std::string& name) {
  const Bytes bytes = read_picture_bytes(name);
  return {name, decode_picture(bytes, name), find_notes(name, bytes), is_png(bytes)};
}

void check_same_size(const NamedPicture& a, const NamedPicture& b) {
  const Image& one = a.picture.image;
  const Image& other = b.picture.image;
  if (one.width == other.width && one.height == other.height) return;
  throw UsageError("'" + a.name + "' is " + size_text({one.width, one.height}) + " pixels and '" +
                   b.name + "' " + size_text({other.width, other.height}) +
                   "; they must be of one size");
}

void check_depths(const NamedPicture& of) {
  const Image& image = of.picture.image;
  for (int y = 0; y < image.height; ++y) {
    const auto values = row<std::uint16_t>(image, y);
    for (std::size_t i = 3; i < values.size(); i += 4) {
      const float depth = half_to_float(values[i]);
      if (is_depth(depth)) continue;
      throw FileError("--regions: alpha of '" + of.name + "' is no depth: it is " +
                      short_number(static_cast<double>(depth)) + " at pixel " +
                      std::to_string(i / 4) + "," + std::to_string(y) +
                      " and must be metres above 0 everywhere");
    }
  }
}

/// Labels, and up to which circle pixels are in focus.
std::pair<Image, float> regions_of(const NamedPicture& depths, const NotedLens& lens) {
  if (!depths.picture.has_alpha) {
    throw UsageError("--regions: '" + depths.name +
                     "' has no depth in alpha; give --depth with a .npy that has");
  }
  check_depths(depths);
  const Image& image = depths.picture.image;
  const PixelCoc coc =
      checked_pixel_coc(lens.lens, lens.fov_y_degrees, image.height, lens.coc_scale);
  Image labels = label_regions(image, coc);
  const float focus_px = fitting_focus_px(image, coc, labels);
  if (focus_px > kFocusRadiusPx) labels = label_regions(image, coc, focus_px);
  return {std::move(labels), focus_px};
}

/// Labels the regions if they are wanted, and finds the lens that they are of.
std::optional<Image> regions_wanted(const NamedPicture& a, const NamedPicture& b,
                                    const CompareOptions& options, CompareFindings& findings) {
  std::vector<NamedNotes> notes{{b.name, b.notes}, {a.name, a.notes}};
  findings.doubts = lens_doubts(notes);
  if (!options.regions) return std::nullopt;
  std::optional<NamedPicture> deep;
  if (options.depth_file) {
    deep = read_named(*options.depth_file);
    check_same_size(*deep, b);
    notes.push_back({deep->name, deep->notes});
  }
  findings.lens = assumed_lens(options, notes);
  std::vector<ReadFile> inputs;
  for (const auto& file : findings.lens->files) inputs.push_back({file, "a file of --scene"});
  check_maps(options, inputs);
  const NamedPicture& own = b.picture.has_alpha || !a.picture.has_alpha ? b : a;
  auto [labels, focus_px] = regions_of(deep ? *deep : own, findings.lens->lens);
  findings.focus_px = focus_px;
  return std::move(labels);
}

void write_map(const std::optional<std::string>& name, const Image& map) {
  WholeFile file{*name};
  file.write(encode(map, *format_by_extension(*name)));
  file.commit();
}

/// Of what nobody sees the colour does not count.
void clear_unseen(Image& a, Image& b) {
  for (int y = 0; y < a.height; ++y) {
    const auto of_a = row<std::uint16_t>(a, y), of_b = row<std::uint16_t>(b, y);
    for (std::size_t i = 0; i < of_a.size(); i += 4) {
      if (of_a[i + 3] != 0 || of_b[i + 3] != 0) continue;
      for (std::size_t c = i; c < i + 3; ++c) of_a[c] = of_b[c] = 0;
    }
  }
}

bool have_opacity(const NamedPicture& a, const NamedPicture& b) {
  return a.is_straight && b.is_straight && a.picture.has_alpha && b.picture.has_alpha;
}

/// If only one has alpha, both are cleared: there is nothing to compare it with.
Difference counted(Picture& a, Picture& b) {
  const bool with_alpha = a.has_alpha && b.has_alpha;
  if (!with_alpha) {
    clear_alpha(a.image);
    clear_alpha(b.image);
  }
  Difference difference = compare_images(a.image, b.image);
  if (!with_alpha) {
    const std::uint64_t alphas = difference.values / 4;
    difference.values -= alphas;
    difference.ulp_histogram[0] -= alphas;
  }
  return difference;
}

/// Where the difference is drawn, and how the new picture takes the place of what it should be.
std::string way_on(const CompareOptions& options) {
  const std::optional<std::string>& map =
      options.flip_map_file ? options.flip_map_file : options.ulp_map_file;
  std::string text = map ? "the difference is drawn in '" + *map + "'"
                         : std::string{"--diff OUT.png draws the difference"};
  if (options.first != "-" && options.second != "-") {
    text += "; cp '" + options.first + "' '" + options.second + "' accepts the new picture";
  }
  return text;
}

int compare_pictures(const CompareOptions& options) {
  NamedPicture a = read_named(options.first);
  NamedPicture b = read_named(options.second);
  check_same_size(a, b);
  const Image& image_a = a.picture.image;
  const Image& image_b = b.picture.image;

  CompareFindings findings;
  const std::optional<Image> regions = regions_wanted(a, b, options, findings);
  Difference& difference = findings.difference;
  if (have_opacity(a, b)) clear_unseen(a.picture.image, b.picture.image);
  difference = counted(a.picture, b.picture);
  if (difference.differing != 0) {
    const auto index = static_cast<std::size_t>(4 * difference.first_x + difference.first_channel);
    findings.channel = "RGBA"[difference.first_channel];
    findings.first_a = half_to_float(row<std::uint16_t>(image_a, difference.first_y)[index]);
    findings.first_b = half_to_float(row<std::uint16_t>(image_b, difference.first_y)[index]);
  }
  // Equal pictures are one line of text, and need no measuring.
  if (difference.differing != 0 || options.json || options.regions || options.flip_map_file ||
      options.tolerance.max_flip) {
    ThreadPool pool{hardware_threads()};
    findings.measured =
        measure_pictures(image_b, image_a, regions ? &*regions : nullptr, options.measures, pool);
  }
  if (options.code_threshold) {
    findings.codes = compare_codes(image_a, image_b, *options.code_threshold);
  }
  if (options.point_radius_px) {
    const double radius = *options.point_radius_px;
    findings.point = {point_shape(image_a), point_shape(image_b), radius,
                      disc_deviation(image_a, radius), disc_deviation(image_b, radius)};
  }
  if (options.flip_map_file)
    write_map(options.flip_map_file, heat_picture(findings.measured->flip));
  if (options.ulp_map_file) write_map(options.ulp_map_file, difference_picture(image_a, image_b));
  std::optional<std::uint64_t> beyond;
  if (const Tolerance& tolerance = options.tolerance; counts_pixels(tolerance)) {
    beyond = pixels_beyond(image_a, image_b,
                           {tolerance.max_difference.value_or(0.0), have_opacity(a, b),
                            tolerance.search_px.value_or(0)});
  }
  findings.limits = check_limits(
      options.tolerance, difference,
      findings.measured ? std::optional{findings.measured->whole.flip} : std::nullopt, beyond);
  const bool is_good =
      findings.limits.empty() ? difference.differing == 0 : within_limits(findings);
  if (!is_good) findings.go_on = way_on(options);
  (options.json ? print_compare_json : print_compare_text)(findings);
  return is_good ? kEqual : kDifferent;
}

/// Two frames of each sequence are in memory at a time.
int compare_sequences(const CompareOptions& options) {
  const ToneTable tone = srgb_encoded(clamped_tone());
  std::vector<double> steps;
  NamedPicture before = read_named(options.frames.front());
  NamedPicture truth_before = read_named(options.truth.front());
  check_same_size(truth_before, before);
  for (std::size_t t = 1; t < options.frames.size(); ++t) {
    NamedPicture after = read_named(options.frames[t]);
    NamedPicture truth_after = read_named(options.truth[t]);
    check_same_size(after, before);
    check_same_size(truth_after, before);
    steps.push_back(flicker({before.picture.image, after.picture.image, truth_before.picture.image,
                             truth_after.picture.image},
                            tone));
    before = std::move(after);
    truth_before = std::move(truth_after);
  }
  (options.json ? print_flicker_json : print_flicker_text)(steps);
  return mean_flicker(steps) == 0.0 ? kEqual : kDifferent;
}

}  // namespace

Command add_compare_command(CLI::App& program) {
  CLI::App* parser = add_command(
      program, "compare",
      "Count and measure differences of pictures; status 0 equal or within the tolerance, 1 not, 2 "
      "error");
  const auto options = std::make_shared<CompareOptions>();
  add_compare_options(*parser, *options);
  return {parser, [options] {
            check_compare_options(*options);
            return options->frames.empty() ? compare_pictures(*options)
                                           : compare_sequences(*options);
          }};
}

}  // namespace softfocus

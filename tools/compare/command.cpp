// softfocus compare: how two pictures differ, counted, measured and shown.

#include <memory>

#include "dof/measure/flicker.h"
#include "dof/measure/heat_map.h"
#include "raster/numbers/half.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"
#include "tools/compare/options.h"
#include "tools/compare/report.h"
#include "tools/files/image_file.h"
#include "tools/files/whole_file.h"

namespace softfocus {
namespace {

// As diff has it.
constexpr int kEqual = 0;
constexpr int kDifferent = 1;

/// A picture and what its file is called.
struct NamedPicture {
  std::string name;
  Picture picture;
};

NamedPicture read_named(const std::string& name) { return {name, read_image_file(name)}; }

void check_same_size(const NamedPicture& a, const NamedPicture& b) {
  const Image& one = a.picture.image;
  const Image& other = b.picture.image;
  if (one.width == other.width && one.height == other.height) return;
  throw UsageError("'" + a.name + "' is " + size_text({one.width, one.height}) + " pixels and '" +
                   b.name + "' " + size_text({other.width, other.height}) +
                   "; they must be of one size");
}

void clear_alpha(Image& image) {
  for (int y = 0; y < image.height; ++y) {
    const auto values = row<std::uint16_t>(image, y);
    for (std::size_t i = 3; i < values.size(); i += 4) values[i] = 0;
  }
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

Image regions_of(const NamedPicture& depths, const CompareOptions& options) {
  if (!depths.picture.has_alpha) {
    throw UsageError("--regions: '" + depths.name +
                     "' has no depth in alpha; give --depth with a .npy that has");
  }
  check_depths(depths);
  const ThinLens lens = overruled(ThinLens{}, options.lens);
  check_lens(lens, options.lens, "the default lens");
  return label_regions(
      depths.picture.image,
      checked_pixel_coc(lens, options.fov_y_degrees.value_or(40.0), depths.picture.image.height,
                        options.lens.coc_scale.value_or(1.0)));
}

std::optional<Image> regions_wanted(const NamedPicture& a, const NamedPicture& b,
                                    const CompareOptions& options) {
  if (!options.regions) return std::nullopt;
  if (options.depth_file) {
    const NamedPicture depths = read_named(*options.depth_file);
    check_same_size(depths, b);
    return regions_of(depths, options);
  }
  return regions_of(b.picture.has_alpha || !a.picture.has_alpha ? b : a, options);
}

void write_map(const std::optional<std::string>& name, const Image& map) {
  WholeFile file{*name};
  file.write(encode(map, *format_by_extension(*name)));
  file.commit();
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

int compare_pictures(const CompareOptions& options) {
  NamedPicture a = read_named(options.first);
  NamedPicture b = read_named(options.second);
  check_same_size(a, b);
  const std::optional<Image> regions = regions_wanted(a, b, options);
  const Image& image_a = a.picture.image;
  const Image& image_b = b.picture.image;

  CompareFindings findings;
  findings.regions = options.regions;
  Difference& difference = findings.difference;
  difference = counted(a.picture, b.picture);
  if (difference.differing != 0) {
    const auto index = static_cast<std::size_t>(4 * difference.first_x + difference.first_channel);
    findings.channel = "RGBA"[difference.first_channel];
    findings.first_a = half_to_float(row<std::uint16_t>(image_a, difference.first_y)[index]);
    findings.first_b = half_to_float(row<std::uint16_t>(image_b, difference.first_y)[index]);
  }
  // Equal pictures are one line of text, and need no measuring.
  if (difference.differing != 0 || options.json || options.regions || options.flip_map_file) {
    ThreadPool pool{hardware_threads()};
    findings.measured =
        measure_pictures(image_b, image_a, regions ? &*regions : nullptr, options.measures, pool);
  }
  if (options.point_radius_px) {
    const double radius = *options.point_radius_px;
    findings.point = {point_shape(image_a), point_shape(image_b), radius,
                      disc_deviation(image_a, radius), disc_deviation(image_b, radius)};
  }
  if (options.flip_map_file)
    write_map(options.flip_map_file, heat_picture(findings.measured->flip));
  if (options.ulp_map_file) write_map(options.ulp_map_file, difference_picture(image_a, image_b));
  (options.json ? print_compare_json : print_compare_text)(findings);
  return difference.differing == 0 ? kEqual : kDifferent;
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
      "Count and measure differences of pictures; status 0 equal, 1 different, 2 error");
  const auto options = std::make_shared<CompareOptions>();
  add_compare_options(*parser, *options);
  return {parser, [options] {
            check_compare_options(*options);
            return options->frames.empty() ? compare_pictures(*options)
                                           : compare_sequences(*options);
          }};
}

}  // namespace softfocus

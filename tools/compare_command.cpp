// softfocus compare: how two pictures differ, counted and shown.

#include <cmath>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "dof/difference.h"
#include "raster/numbers/half.h"
#include "tools/command_line.h"
#include "tools/commands.h"
#include "tools/errors.h"
#include "tools/image_file.h"
#include "tools/option_values.h"
#include "tools/whole_file.h"

namespace softfocus {
namespace {

struct CompareOptions {
  std::string first;
  std::string second;
  std::string difference;
  bool json = false;
};

std::string size_of(const Image& image) {
  return std::to_string(image.width) + "x" + std::to_string(image.height);
}

void clear_alpha(Image& image) {
  for (int y = 0; y < image.height; ++y) {
    const auto values = row<std::uint16_t>(image, y);
    for (std::size_t i = 3; i < values.size(); i += 4) values[i] = 0;
  }
}

/// The first differing value in both pictures.
struct FirstDifference {
  char channel;
  float a;
  float b;
};
FirstDifference first_difference(const Difference& d, const Image& a, const Image& b) {
  const auto index = static_cast<std::size_t>(4 * d.first_x + d.first_channel);
  return {"RGBA"[d.first_channel], half_to_float(row<std::uint16_t>(a, d.first_y)[index]),
          half_to_float(row<std::uint16_t>(b, d.first_y)[index])};
}

std::string bucket_name(std::size_t bucket) {
  if (bucket < 2) return std::to_string(bucket);
  return std::to_string(1 << (bucket - 1)) + " to " + std::to_string((1 << bucket) - 1);
}

void print_text(const Difference& d, const Image& a, const Image& b) {
  std::cout << "differing values    " << d.differing << " of " << d.values << '\n';
  if (d.differing == 0) return;
  const auto first = first_difference(d, a, b);
  std::cout << "largest difference  " << d.max_ulp << " half-ULPs\n"
            << "first difference    pixel " << d.first_x << ',' << d.first_y << " channel "
            << first.channel << ": " << short_number(static_cast<double>(first.a)) << " and "
            << short_number(static_cast<double>(first.b)) << '\n'
            << "PSNR of colour      " << short_number(d.psnr_db) << " dB\n"
            << "half-ULPs           values\n";
  for (std::size_t bucket = 0; bucket < d.ulp_histogram.size(); ++bucket) {
    if (d.ulp_histogram[bucket] == 0) continue;
    const std::string name = bucket_name(bucket);
    std::cout << "  " << name << std::string(18 - name.size(), ' ') << d.ulp_histogram[bucket]
              << '\n';
  }
}

void print_json(const Difference& d, const Image& a, const Image& b) {
  using nlohmann::ordered_json;
  ordered_json json{{"equal", d.differing == 0}, {"values", d.values},
                    {"differing", d.differing},  {"max_half_ulps", d.max_ulp},
                    {"psnr_db", nullptr},  // JSON has no infinity
                    {"first", nullptr},          {"histogram", ordered_json::array()}};
  if (std::isfinite(d.psnr_db)) json["psnr_db"] = d.psnr_db;
  if (d.differing != 0) {
    const auto first = first_difference(d, a, b);
    json["first"] = {{"x", d.first_x},
                     {"y", d.first_y},
                     {"channel", std::string(1, first.channel)},
                     {"a", first.a},
                     {"b", first.b}};
  }
  for (std::size_t bucket = 0; bucket < d.ulp_histogram.size(); ++bucket) {
    if (d.ulp_histogram[bucket] == 0) continue;
    json["histogram"].push_back(
        {{"half_ulps", bucket_name(bucket)}, {"values", d.ulp_histogram[bucket]}});
  }
  std::cout << json.dump(2) << '\n';
}

int compare(const CompareOptions& options) {
  std::optional<FileFormat> difference_format;
  if (!options.difference.empty()) {
    difference_format = format_by_extension(options.difference);
    if (!difference_format) {
      throw UsageError("--diff '" + options.difference +
                       "': the name must end in .png, .pfm or .npy");
    }
  }
  Picture a = read_image_file(options.first);
  Picture b = read_image_file(options.second);
  if (a.image.width != b.image.width || a.image.height != b.image.height) {
    throw UsageError("'" + options.first + "' is " + size_of(a.image) + " pixels and '" +
                     options.second + "' " + size_of(b.image) + "; they must be of one size");
  }
  // Where one has no alpha there is nothing to compare the other's with.
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
  if (difference_format) {
    WholeFile file{options.difference};
    file.write(encode(difference_picture(a.image, b.image), *difference_format));
    file.commit();
  }
  (options.json ? print_json : print_text)(difference, a.image, b.image);
  return difference.differing == 0 ? 0 : 1;
}

}  // namespace

Command add_compare_command(CLI::App& program) {
  CLI::App* parser = program.add_subcommand(
      "compare", "Count the differences of two pictures; status 0 equal, 1 different, 2 error");
  const auto options = std::make_shared<CompareOptions>();
  add_argument(*parser, "A", "A picture: .npy, .pfm or .png", options->first);
  add_argument(*parser, "B", "Another of the same size", options->second);
  add_value(*parser, "--diff", "OUT",
            "Write a map of the differences: black equal, blue 1 half-ULP to red 2^15",
            [options](const std::string& text) { options->difference = text; });
  parser->add_flag("--json", options->json, "Print JSON");
  return {parser, [options] { return compare(*options); }};
}

}  // namespace softfocus

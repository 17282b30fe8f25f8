#include "tools/options/lens_options.h"

#include <cmath>
#include <utility>

#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"
#include "tools/options/lengths.h"

namespace softfocus {
namespace {

// Far past anything real, and far from the limits of single precision. What is too
// small, lens_error() knows.
constexpr double kLargest = 1e9;

/// Checks one value by putting it into a lens in which nothing else can be wrong.
double checked(std::string_view option, const std::string& text, std::string_view wanted,
               ThinLens lens, double ThinLens::*value) {
  const auto parse = value == &ThinLens::focus_m           ? parse_metres
                     : value == &ThinLens::focal_length_mm ? parse_millimetres
                                                           : parse_f_number;
  lens.*value = parse(option, text, -kLargest, kLargest, wanted);
  if (const char* error = lens_error(lens)) {
    throw UsageError(std::string{option} + " " + text + ": " + error);
  }
  return lens.*value;
}

/// For the help.
struct LensDefaults {
  std::string focus, focal_length, f_number, coc_scale;
};

void add_lens_options(CLI::App& parser, LensOptions& options, const LensDefaults& defaults) {
  const auto add = [&](const char* name, const char* type, const std::string& help,
                       const std::string& standard, const char* wanted, double ThinLens::*value,
                       std::optional<double>& place) {
    add_value(parser, name, type, help + " (default: " + standard + ")",
              [=, &place](const std::string& text) {
                constexpr ThinLens kSound{
                    .focal_length_mm = 1e-9, .f_number = 1.0, .focus_m = 1e300};
                place = checked(name, text, wanted, kSound, value);
              });
  };
  add("--focus", "METRES", "Distance in focus, along the axis", defaults.focus,
      "a distance in metres above 0 (at most 1e9), such as 2.5 or 250cm", &ThinLens::focus_m,
      options.focus_m);
  add("--focal-length", "MM", "Focal length", defaults.focal_length,
      "a focal length in millimetres above 0 (at most 1e9), such as 50", &ThinLens::focal_length_mm,
      options.focal_length_mm);
  add("--f-number", "N", "Focal length over aperture", defaults.f_number,
      "an f-number above 0 (at most 1e9), such as 2.8", &ThinLens::f_number, options.f_number);
  add_value(
      parser, "--coc-scale", "S",
      "Exaggeration of the circles, 1 = the lens itself (default: " + defaults.coc_scale + ")",
      [&place = options.coc_scale](const std::string& text) {
        place = parse_number("--coc-scale", text, 0.0, 1e6, "a factor from 0 to 1000000");
      });
}

void add_fov(CLI::App& parser, const std::string& standard,
             std::function<void(double degrees)> on_fov) {
  add_value(parser, "--fov", "DEGREES", "Vertical field of view (default: " + standard + ")",
            [on_fov = std::move(on_fov)](const std::string& text) {
              on_fov(parse_number("--fov", text, 0.01, 179.0, "degrees from 0.01 to 179"));
            });
}

}  // namespace

void add_lens_options(CLI::App& parser, LensOptions& options) {
  const std::string scenes = "the scene's";
  add_lens_options(parser, options, {scenes, scenes, scenes, scenes});
}

void add_own_lens_options(CLI::App& parser, LensOptions& options,
                          std::function<void(double degrees)> on_fov) {
  const ThinLens standard;
  add_lens_options(parser, options,
                   {.focus = short_number(standard.focus_m),
                    .focal_length = short_number(standard.focal_length_mm),
                    .f_number = short_number(standard.f_number),
                    .coc_scale = "1"});
  add_fov(parser, "40", std::move(on_fov));
}

void add_compared_lens_options(CLI::App& parser, LensOptions& options,
                               std::function<void(double degrees)> on_fov) {
  const std::string theirs = "--scene's or the picture's";
  add_lens_options(parser, options, {theirs, theirs, theirs, theirs});
  add_fov(parser, theirs, std::move(on_fov));
}

void add_refocus_lens_options(CLI::App& parser, LensOptions& options,
                              std::function<void(double degrees)> on_fov) {
  add_lens_options(parser, options,
                   {.focus = "what is in the middle",
                    .focal_length = "the picture's or 50",
                    .f_number = "the picture's or 2",
                    .coc_scale = "the picture's or 1"});
  add_fov(parser, "the picture's, or by --sensor", std::move(on_fov));
}

ThinLens overruled(ThinLens lens, const LensOptions& options) {
  lens.focal_length_mm = options.focal_length_mm.value_or(lens.focal_length_mm);
  lens.f_number = options.f_number.value_or(lens.f_number);
  lens.focus_m = options.focus_m.value_or(lens.focus_m);
  return lens;
}

void check_lens(const ThinLens& lens, const LensOptions& options, std::string_view otherwise) {
  const char* error = lens_error(lens);
  if (error == nullptr) return;
  std::string given;
  const auto add = [&](const char* option, std::optional<double> value, const char* unit) {
    if (value) given += (given.empty() ? "" : ", ") + (option + short_number(*value)) + unit;
  };
  add("--focal-length ", options.focal_length_mm, " mm");
  add("--focus ", options.focus_m, " m");
  if (given.empty()) given = otherwise;
  throw UsageError(given + " (the lens is " + short_number(lens.focal_length_mm) +
                   " mm, focused at " + short_number(lens.focus_m) + " m): " + error);
}

PixelCoc checked_pixel_coc(const ThinLens& lens, double fov_y_degrees, int height_px,
                           double coc_scale) {
  const PixelCoc coc = pixel_coc(lens, fov_y_degrees, height_px, coc_scale);
  if (std::isfinite(coc.radius_at_infinity_px) && std::isfinite(coc.focus_m)) return coc;
  throw UsageError(
      "the lens's circles are too large to compute with: give a larger --f-number, "
      "a nearer --focus or a smaller --coc-scale");
}

}  // namespace softfocus

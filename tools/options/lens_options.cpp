#include "tools/options/lens_options.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "dof/parameters.h"
#include "scenes/draw/frame_matrices.h"
#include "scenes/parameters.h"
#include "tools/cli/errors.h"
#include "tools/options/parameter_options.h"

namespace softfocus {
namespace {

/// FRAME:VALUE, as often as wanted, with blanks or commas between them.
std::vector<Keyframe> parse_keys(const std::string& option, const std::string& text,
                                 const Parameter& parameter) {
  constexpr const char* kSeparators = " ,\t\n";
  std::vector<Keyframe> keys;
  const auto refuse = [&](const std::string& word) {
    throw UsageError(option + " '" + word + "': give " + wanted_text(parameter) +
                     "; or FRAME:VALUE for some frames, which increase, such as '1:2 48:6'");
  };
  for (std::size_t start = text.find_first_not_of(kSeparators); start != text.npos;) {
    const std::size_t end = std::min(text.find_first_of(kSeparators, start), text.size());
    const std::string word = text.substr(start, end - start);
    const std::size_t colon = word.find(':');
    if (colon == word.npos) refuse(word);
    Keyframe key;
    try {
      key.frame = parse_parameter(option, word.substr(0, colon), parameter::kFrame);
      key.value = parse_parameter(option, word.substr(colon + 1), parameter);
    } catch (const UsageError&) {  // which knows a part of the word alone
      refuse(word);
    }
    if (!keys.empty() && key.frame <= keys.back().frame) refuse(word);
    keys.push_back(key);
    start = text.find_first_not_of(kSeparators, end);
  }
  return keys;
}

/// For the help.
struct LensDefaults {
  std::string focus, focal_length, f_number, coc_scale;
};

enum class Keys : std::uint8_t { none, some };

void add_keyed(CLI::App& parser, const Parameter& parameter, const std::string& standard,
               std::optional<double>& place, std::vector<Keyframe>& keys, Keys has_keys) {
  if (has_keys == Keys::none) return add_parameter(parser, parameter, standard, place);
  const std::string option = "--" + std::string{parameter.name};
  add_value(parser, option, std::string{parameter.type},
            help_of(parameter, ", or FRAME:VALUE for some frames", standard),
            [&parameter, &place, &keys, option](const std::string& text) {
              if (text.find(':') == text.npos) {
                place = parse_parameter(option, text, parameter);
              } else {
                keys = parse_keys(option, text, parameter);
              }
            });
}

void add_lens_options(CLI::App& parser, LensOptions& options, const LensDefaults& defaults,
                      Keys has_keys = Keys::none) {
  add_keyed(parser, parameter::kFocus, defaults.focus, options.focus_m, options.focus_m_by_frame,
            has_keys);
  add_parameter(parser, parameter::kFocalLength, defaults.focal_length, options.focal_length_mm);
  add_keyed(parser, parameter::kFNumber, defaults.f_number, options.f_number,
            options.f_number_by_frame, has_keys);
  add_parameter(parser, parameter::kCocScale, defaults.coc_scale, options.coc_scale);
  if (has_keys == Keys::none) return;
  add_choice(parser, "--keyframes",
             "The way from key to key of --focus and --f-number (default: linear)",
             parameter::kEasings, options.easing);
}

void add_fov(CLI::App& parser, const std::string& standard,
             std::function<void(double degrees)> on_fov) {
  add_parameter(parser, parameter::kFov, standard, std::move(on_fov));
}

}  // namespace

void add_lens_options(CLI::App& parser, LensOptions& options) {
  const std::string scenes = "the scene's";
  add_lens_options(parser, options, {scenes, scenes, scenes, scenes});
}

void add_animated_lens_options(CLI::App& parser, LensOptions& options) {
  const std::string scenes = "the scene's";
  add_lens_options(parser, options, {scenes, scenes, scenes, scenes}, Keys::some);
}

void add_own_lens_options(CLI::App& parser, LensOptions& options,
                          std::function<void(double degrees)> on_fov) {
  add_lens_options(parser, options,
                   {.focus = plain_number(parameter::kFocus.preset),
                    .focal_length = plain_number(parameter::kFocalLength.preset),
                    .f_number = plain_number(parameter::kFNumber.preset),
                    .coc_scale = plain_number(parameter::kCocScale.preset)});
  add_fov(parser, plain_number(parameter::kFov.preset), std::move(on_fov));
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
                   {.focus = "an EXR's own, or what is in the middle",
                    .focal_length = "the picture's or 50",
                    .f_number = "the picture's or 2",
                    .coc_scale = "the picture's or 1"},
                   Keys::some);
  add_fov(parser, "the picture's, or by --sensor", std::move(on_fov));
}

LensOptions at_frame(LensOptions options, double frame) {
  const auto set = [&](std::optional<double>& value, std::vector<Keyframe>& keys) {
    if (!keys.empty()) value = value_at(keys, options.easing, frame);
    keys.clear();
  };
  set(options.focus_m, options.focus_m_by_frame);
  set(options.f_number, options.f_number_by_frame);
  return options;
}

std::string lens_text(const LensOptions& options) {
  return (options.focus_m ? "focus " + exact_number(*options.focus_m) + "\n" : "") +
         (options.f_number ? "f-number " + exact_number(*options.f_number) + "\n" : "");
}

void check_no_keys(const LensOptions& options) {
  const bool of_focus = !options.focus_m_by_frame.empty();
  if (!of_focus && options.f_number_by_frame.empty()) return;
  throw UsageError(std::string{of_focus ? "--focus" : "--f-number"} +
                   ": FRAME:VALUE is of many frames; give one value, or --frames A..B");
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

void check_pixel_coc(const PixelCoc& coc) {
  if (std::isfinite(coc.radius_at_infinity_px) && std::isfinite(coc.focus_m)) return;
  throw UsageError(
      "the lens's circles are too large to compute with: give a larger --f-number, "
      "a nearer --focus or a smaller --coc-scale");
}

PixelCoc checked_pixel_coc(const ThinLens& lens, double fov_y_degrees, int height_px,
                           double coc_scale) {
  const PixelCoc coc = pixel_coc(lens, fov_y_degrees, height_px, coc_scale);
  check_pixel_coc(coc);
  return coc;
}

}  // namespace softfocus

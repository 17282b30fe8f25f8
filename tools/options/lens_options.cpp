#include "tools/options/lens_options.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "dof/parameters.h"
#include "raster/numbers/parameter_text.h"
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

enum class Keys : std::uint8_t { none, some };

void add_keyed(CLI::App& parser, const Parameter& parameter, const std::string& standard,
               std::optional<double>& place, std::vector<Keyframe>& keys) {
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

/// `standard` gives the help's default of a number.
void add_lens_options(CLI::App& parser, LensOptions& options,
                      const std::function<std::string(const Parameter&)>& standard,
                      Keys has_keys = Keys::none) {
  for (const LensNumber& number : kLensNumbers) {
    const Parameter& parameter = number.parameter;
    std::optional<double>& place = options.given[number.place];
    if (has_keys == Keys::some && number.has_keys) {
      add_keyed(parser, parameter, standard(parameter), place, options.keys[number.place]);
    } else {
      add_parameter(parser, parameter, standard(parameter), place);
    }
  }
  add_parameter(parser, parameter::kCocScale, standard(parameter::kCocScale), options.coc_scale);
  if (has_keys == Keys::none) return;
  add_choice(parser, "--keyframes",
             "The way from key to key of --focus and --f-number (default: linear)",
             parameter::kEasings, options.easing);
}

std::string of_scene(const Parameter&) { return "the scene's"; }
std::string preset_of(const Parameter& parameter) { return plain_number(parameter.preset); }

}  // namespace

void add_lens_options(CLI::App& parser, LensOptions& options) {
  add_lens_options(parser, options, of_scene);
}

void add_animated_lens_options(CLI::App& parser, LensOptions& options) {
  add_lens_options(parser, options, of_scene, Keys::some);
}

void add_own_lens_options(CLI::App& parser, LensOptions& options,
                          std::function<void(double degrees)> on_fov) {
  add_lens_options(parser, options, preset_of);
  add_parameter(parser, parameter::kFov, preset_of(parameter::kFov), std::move(on_fov));
}

void add_compared_lens_options(CLI::App& parser, LensOptions& options,
                               std::function<void(double degrees)> on_fov) {
  constexpr const char* kTheirs = "--scene's or the picture's";
  add_lens_options(parser, options, [](const Parameter&) { return kTheirs; });
  add_parameter(parser, parameter::kFov, kTheirs, std::move(on_fov));
}

void add_refocus_lens_options(CLI::App& parser, LensOptions& options,
                              std::function<void(double degrees)> on_fov) {
  const auto standard = [](const Parameter& parameter) {
    return &parameter == &parameter::kFocus ? "an EXR's own, or what is in the middle"
                                            : "the picture's or " + preset_of(parameter);
  };
  add_lens_options(parser, options, standard, Keys::some);
  add_parameter(parser, parameter::kFov, "the picture's, or by --sensor", std::move(on_fov));
}

LensOptions at_frame(LensOptions options, double frame) {
  for (const LensNumber& number : kLensNumbers) {
    std::vector<Keyframe>& keys = options.keys[number.place];
    if (!keys.empty()) options.given[number.place] = value_at(keys, options.easing, frame);
    keys.clear();
  }
  return options;
}

std::string lens_text(const LensOptions& options) {
  std::string text;
  for (const auto& [parameter, place, has_keys] : kLensNumbers) {
    const std::optional<double>& value = options.given[place];
    if (!has_keys || !value) continue;
    text.append(parameter.name).append(" ").append(exact_number(*value)).append("\n");
  }
  return text;
}

void check_no_keys(const LensOptions& options) {
  for (const LensNumber& number : kLensNumbers) {
    if (options.keys[number.place].empty()) continue;
    throw UsageError("--" + std::string{number.parameter.name} +
                     ": FRAME:VALUE is of many frames; give one value, or --frames A..B");
  }
}

ThinLens overruled(ThinLens lens, const LensOptions& options) {
  for (const LensNumber& number : kLensNumbers) {
    double& value = lens.*number.place;
    value = options.given[number.place].value_or(value);
  }
  return lens;
}

void check_lens(const ThinLens& lens, const LensOptions& options, std::string_view otherwise) {
  const char* error = lens_error(lens);
  if (error == nullptr) return;
  std::string given;
  const auto add = [&](const char* option, std::optional<double> value, const char* unit) {
    if (value) given += (given.empty() ? "" : ", ") + (option + short_number(*value)) + unit;
  };
  add("--focal-length ", options.given[&ThinLens::focal_length_mm], " mm");
  add("--focus ", options.given[&ThinLens::focus_m], " m");
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

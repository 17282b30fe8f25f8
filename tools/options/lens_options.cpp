#include "tools/options/lens_options.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "scenes/draw/keyframes.h"
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

/// FRAME:VALUE, as often as wanted, with blanks or commas between them.
template <class ParseValue>
std::vector<Keyframe> parse_keys(const std::string& option, const std::string& text,
                                 const std::string& wanted, ParseValue parse_value) {
  constexpr const char* kSeparators = " ,\t\n";
  constexpr double kFarthestFrame = 1e9;
  const std::string keys_wanted =
      wanted + "; or FRAME:VALUE for some frames, which increase, such as '1:2 48:6'";
  std::vector<Keyframe> keys;
  for (std::size_t start = text.find_first_not_of(kSeparators); start != text.npos;) {
    const std::size_t end = std::min(text.find_first_of(kSeparators, start), text.size());
    const std::string word = text.substr(start, end - start);
    const std::size_t colon = word.find(':');
    const auto refuse = [&] {
      throw UsageError(
          std::string{option}.append(" '").append(word).append("': give ").append(keys_wanted));
    };
    if (colon == word.npos) refuse();
    Keyframe key;
    try {
      key.frame = parse_number(option, word.substr(0, colon), 0.0, kFarthestFrame, "");
    } catch (const UsageError&) {  // which knows the frame alone
      refuse();
    }
    key.value = parse_value(word.substr(colon + 1), keys_wanted);
    if (!keys.empty() && key.frame <= keys.back().frame) refuse();
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

void add_lens_options(CLI::App& parser, LensOptions& options, const LensDefaults& defaults,
                      Keys has_keys = Keys::none) {
  const auto add = [&](const char* name, const char* type, const std::string& help,
                       const std::string& standard, const char* wanted, double ThinLens::*value,
                       std::optional<double>& place, std::vector<Keyframe>* keys = nullptr) {
    const bool keyed = keys != nullptr && has_keys == Keys::some;
    add_value(parser, name, type,
              help + (keyed ? ", or FRAME:VALUE for some frames (default: " : " (default: ") +
                  standard + ")",
              [=, &place](const std::string& text) {
                constexpr ThinLens kSound{
                    .focal_length_mm = 1e-9, .f_number = 1.0, .focus_m = 1e300};
                if (!keyed || text.find(':') == text.npos) {
                  place = checked(name, text, wanted, kSound, value);
                  return;
                }
                *keys = parse_keys(name, text, wanted,
                                   [&](const std::string& word, const std::string& keys_wanted) {
                                     return checked(name, word, keys_wanted, kSound, value);
                                   });
              });
  };
  add("--focus", "METRES", "Distance in focus, along the axis", defaults.focus,
      "a distance in metres above 0 (at most 1e9), such as 2.5 or 250cm", &ThinLens::focus_m,
      options.focus_m, &options.focus_m_by_frame);
  add("--focal-length", "MM", "Focal length", defaults.focal_length,
      "a focal length in millimetres above 0 (at most 1e9), such as 50", &ThinLens::focal_length_mm,
      options.focal_length_mm);
  add("--f-number", "N", "Focal length over aperture", defaults.f_number,
      "an f-number above 0 (at most 1e9), such as 2.8", &ThinLens::f_number, options.f_number,
      &options.f_number_by_frame);
  add_value(
      parser, "--coc-scale", "S",
      "Exaggeration of the circles, 1 = the lens itself (default: " + defaults.coc_scale + ")",
      [&place = options.coc_scale](const std::string& text) {
        place = parse_number("--coc-scale", text, 0.0, 1e6, "a factor from 0 to 1000000");
      });
  if (has_keys == Keys::none) return;
  add_value(parser, "--keyframes", "linear|smooth",
            "The way from key to key of --focus and --f-number (default: linear)",
            [&options](const std::string& text) {
              if (text != "linear" && text != "smooth") {
                throw UsageError("--keyframes '" + text + "': there are linear, smooth");
              }
              options.easing = text == "linear" ? Easing::linear : Easing::smooth;
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

void add_animated_lens_options(CLI::App& parser, LensOptions& options) {
  const std::string scenes = "the scene's";
  add_lens_options(parser, options, {scenes, scenes, scenes, scenes}, Keys::some);
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

PixelCoc checked_pixel_coc(const ThinLens& lens, double fov_y_degrees, int height_px,
                           double coc_scale) {
  const PixelCoc coc = pixel_coc(lens, fov_y_degrees, height_px, coc_scale);
  if (std::isfinite(coc.radius_at_infinity_px) && std::isfinite(coc.focus_m)) return coc;
  throw UsageError(
      "the lens's circles are too large to compute with: give a larger --f-number, "
      "a nearer --focus or a smaller --coc-scale");
}

}  // namespace softfocus

#include "tools/refocus/options.h"

#include <algorithm>
#include <array>

#include "raster/images/image.h"
#include "raster/numbers/half.h"
#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"
#include "tools/cli/platform.h"
#include "tools/options/parameter_options.h"

namespace softfocus {
namespace {

/// The pixel of a line of `size` that a place `at`, which may lie outside, shows.
std::size_t shown(int at, int size, Border border) {
  if (border != Border::mirror) return static_cast<std::size_t>(std::clamp(at, 0, size - 1));
  const int period = 2 * size;
  const int place = (at % period + period) % period;
  return static_cast<std::size_t>(place < size ? place : period - 1 - place);
}

bool is_inside(int at, int size) { return at >= 0 && at < size; }

}  // namespace

std::string_view name_of(Border border) {
  constexpr std::string_view kNames[] = {"by-method", "clamp", "mirror", "black"};
  return kNames[static_cast<std::size_t>(border)];
}

Image with_border(const Image& picture, int margin, Border border) {
  Image result =
      make_image(picture.format, picture.width + 2 * margin, picture.height + 2 * margin);
  for (int y = -margin; y < picture.height + margin; ++y) {
    const auto from =
        row<std::uint16_t>(picture, static_cast<int>(shown(y, picture.height, border)));
    const auto to = row<std::uint16_t>(result, y + margin);
    for (int x = -margin; x < picture.width + margin; ++x) {
      const std::size_t place = 4 * shown(x, picture.width, border);
      const std::size_t at = 4 * static_cast<std::size_t>(x + margin);
      const bool is_black =
          border == Border::black && !(is_inside(x, picture.width) && is_inside(y, picture.height));
      for (std::size_t c = 0; c < 3; ++c)
        to[at + c] = is_black ? std::uint16_t{0} : from[place + c];
      to[at + 3] = from[place + 3];
    }
  }
  return result;
}

PlaneValues with_border(const PlaneValues& values, int width, int height, int margin,
                        Border border) {
  PlaneValues result;
  result.reserve(static_cast<std::size_t>(width + 2 * margin) *
                 static_cast<std::size_t>(height + 2 * margin));
  for (int y = -margin; y < height + margin; ++y) {
    const std::size_t start = shown(y, height, border) * static_cast<std::size_t>(width);
    for (int x = -margin; x < width + margin; ++x) {
      const bool is_black =
          border == Border::black && !(is_inside(x, width) && is_inside(y, height));
      result.push_back(is_black ? 0.0f : values[start + shown(x, width, border)]);
    }
  }
  return result;
}

Image without_border(const Image& picture, int margin) {
  Image result =
      make_image(picture.format, picture.width - 2 * margin, picture.height - 2 * margin);
  for (int y = 0; y < result.height; ++y) {
    const auto from = row<std::uint16_t>(picture, y + margin);
    const auto to = row<std::uint16_t>(result, y);
    std::copy_n(from.begin() + std::ptrdiff_t{4} * margin, to.size(), to.begin());
  }
  return result;
}

PlaneValues without_border(const PlaneValues& values, int width, int height, int margin) {
  PlaneValues result;
  for (int y = margin; y < height - margin; ++y) {
    const auto start = values.begin() + std::ptrdiff_t{y} * width;
    result.insert(result.end(), start + margin, start + width - margin);
  }
  return result;
}

namespace {

/// Multiplies each colour by what `raised` makes of its luminance.
template <class Curve>
void bend(const PlaneValues& opacity, Image& picture, const Curve& raised) {
  constexpr double kMost = 65504.0;
  std::size_t pixel = 0;
  for (int y = 0; y < picture.height; ++y) {
    const auto halves = row<std::uint16_t>(picture, y);
    for (std::size_t i = 0; i < halves.size(); i += 4, ++pixel) {
      const double whole = opacity.empty() ? 1.0 : static_cast<double>(opacity[pixel]);
      const auto colour = [&](std::size_t c) {
        return static_cast<double>(half_to_float(halves[i + c]));
      };
      const double light = 0.2126 * colour(0) + 0.7152 * colour(1) + 0.0722 * colour(2);
      const double luminance = light / whole;
      const double wanted = raised(luminance);
      if (!(whole > 0.0) || !(luminance > 0.0) || wanted == luminance) continue;
      for (std::size_t c = 0; c < 3; ++c) {
        const double value = std::clamp(colour(c) * (wanted / luminance), -kMost, kMost);
        halves[i + c] = float_to_half(static_cast<float>(value), HalfRounding::nearest_even);
      }
    }
  }
}

}  // namespace

HighlightCurve parse_highlights(const std::string& text) {
  constexpr const char* kWanted =
      "a gain from 1 and a threshold from 0 as GAIN,THRESHOLD, such as 8,0.9";
  const auto comma = text.find(',');
  try {
    if (comma != text.npos) {
      return {parse_parameter("", text.substr(0, comma), parameter::kHighlightGain),
              parse_parameter("", text.substr(comma + 1), parameter::kHighlightThreshold)};
    }
  } catch (const UsageError&) {  // which knows one number alone
  }
  throw UsageError("--highlights '" + text + "': give " + kWanted);
}

void raise_highlights(const HighlightCurve& highlights, const PlaneValues& opacity,
                      Image& picture) {
  bend(opacity, picture, [&](double luminance) {
    return luminance + (highlights.gain - 1.0) * std::max(luminance - highlights.threshold, 0.0);
  });
}

void lower_highlights(const HighlightCurve& highlights, const PlaneValues& opacity,
                      Image& picture) {
  bend(opacity, picture, [&](double luminance) {
    const double above = luminance - highlights.threshold;
    return above > 0.0 ? highlights.threshold + above / highlights.gain : luminance;
  });
}

namespace {

constexpr std::array kRefocusShows{Choice<RefocusShow>{"image", RefocusShow::image},
                                   Choice<RefocusShow>{"coc", RefocusShow::coc},
                                   Choice<RefocusShow>{"depth", RefocusShow::depth}};
constexpr std::array kBorders{Choice<Border>{"clamp", Border::clamp},
                              Choice<Border>{"mirror", Border::mirror},
                              Choice<Border>{"black", Border::black}};

void check_method(const RefocusOptions& options) {
  if (options.method.of_scene == nullptr) return;
  throw UsageError("--method " + std::string{options.method.name()} +
                   ": it draws a scene anew, and there is a picture alone; give disc-layers, "
                   "two-pass or another filter (softfocus methods)");
}

}  // namespace

void add_refocus_options(CLI::App& parser, RefocusOptions& options) {
  add_argument(parser, "COLOUR",
               "A picture: PNG and JPEG (sRGB), EXR, HDR, PFM (linear), NPY (linear; whole numbers "
               "sRGB); - for standard input",
               options.colour);
  add_optional_argument(parser, "DEPTH", "Its depth, unless COLOUR has it: any of these",
                        options.depth);
  begin_group(parser, "Output");
  add_text(parser, "-o,--output", "FILE",
           "The result: .png, .exr, .tiff, .pfm, .hdr or .npy; - for standard output (required)",
           options.output);
  add_format_option(parser, options.format);
  add_choice(parser, "--show", "The picture with depth of field, or a grey map (default: image)",
             kRefocusShows, options.show);
  add_flag(parser, "--no-layers", "From EXR to EXR: leave out the other layers that came in",
           [&options] { options.keep_layers = false; });
  add_flag(parser, "--json", "Print what was done as JSON on standard output", options.json);
  add_depth_options(parser, options.reading);
  add_text(parser, "--circles", "FILE", kCirclesText, options.circles);
  add_photo_lens_options(parser, options.photo);
  begin_group(parser, "Bokeh");
  add_blades_option(parser, "An aperture", options.aperture.blades);
  add_aperture_options(parser, options.aperture);
  add_value(
      parser, "--highlights", "GAIN,THRESHOLD",
      "Raises what is brighter than THRESHOLD (white is 1), by GAIN for each step, while it is "
      "filtered: for lamps that were clipped",
      [&options](const std::string& text) { options.highlights = parse_highlights(text); });
  add_choice(parser, "--border",
             "What the filter sees beyond the picture: its edge, its mirror image, nothing "
             "(default: the method's own, mostly clamp)",
             kBorders, options.border);
  begin_group(parser, "Method");
  add_method_option(parser, options.method);
  add_arithmetic_option(parser, options.arithmetic);
  add_max_coc_option(parser, options.max_coc_px, "the picture's largest circle");
  add_weight_options(parser, options.leak, options.budget);
  add_flag(parser, "--unmix-edges",
           "Pixels that two surfaces share, as a renderer makes them, are blurred as two",
           options.unmix);
  add_goal_options(parser, options.goal);
  add_sequence_options(parser, options.sequence, "Of the frames only every N-th, from the I-th on");
  begin_group(parser, "Run");
  add_profile_option(parser, options.profile, options.profile_name);
  add_pool_options(parser, options.pool, "the picture is the same");
  add_talk_options(parser, options.verbose, options.quiet);
}

void read_circles(RefocusOptions& options) {
  options.depth = *options.circles;
  options.reading.encoding = &circles_encoding();
  if (options.reading.holes == Holes::background) options.reading.holes = Holes::far_side;
}

void take_circles(RefocusOptions& options, const CLI::App& parser) {
  if (!options.circles) return;
  if (!options.depth.empty()) {
    throw UsageError("--circles and DEPTH '" + options.depth +
                     "' exclude each other: circles take its place");
  }
  for (const char* option :
       {"--depth-encoding", "--near", "--far", "--scale", "--offset", "--baseline", "--focal-px",
        "--depth-along", "--focus", "--focus-at", "--autofocus", "--focus-nearest", "--focus-range",
        "--f-number", "--focal-length", "--sensor", "--fov", "--coc-scale", "--blur-at-infinity"}) {
    check_one_of(parser, {"--circles", option});
  }
  read_circles(options);
}

void complete(RefocusOptions& options, const CLI::App& parser) {
  check_talk(parser);
  settle_format(parser, options.output, options.format);
  const bool masks_by_input = options.reading.mask == "-";
  if ((options.colour == "-") + (options.depth == "-") + masks_by_input > 1) {
    throw UsageError("-: standard input is one file; name the others");
  }
  const bool to_standard_output = options.output == "-";
  if (to_standard_output && options.json) {
    throw UsageError("--json and -o - would both write to standard output; give -o a file");
  }
  if (to_standard_output && is_terminal(kStandardOutput)) {
    throw UsageError("-o -: standard output is a terminal; send it to a file or a program");
  }
  check_photo_lens(parser);
  if (!is_given(parser, "--method")) {
    options.method = default_method(parser, options.profile);
    options.method_by_size = options.method.name() == kDefaultMethod;
  }
  check_method(options);
  check_aperture(parser, options.method.name(), {});
  check_budget(parser, options.method.name());
  check_goal(parser, options.method);
  check_arithmetic(options.arithmetic, options.method.name(), false);
  if (options.unmix && options.show != RefocusShow::image) {
    throw UsageError("--unmix-edges and --show of a map exclude each other");
  }
  if (options.unmix && options.arithmetic != Arithmetic::floats) {
    throw UsageError("--unmix-edges and --arithmetic exclude each other: edges are of floats");
  }
  if (options.highlights && options.arithmetic == Arithmetic::fixed_8) {
    throw UsageError(
        "--highlights and --arithmetic fixed-8 exclude each other: fixed-8 cuts what is brighter "
        "than white");
  }
}

}  // namespace softfocus

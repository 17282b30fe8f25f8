#include "tools/refocus/options.h"

#include <array>

#include "tools/cli/errors.h"
#include "tools/cli/platform.h"
#include "tools/options/parameter_options.h"

namespace softfocus {
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
               "sRGB)",
               options.colour);
  add_optional_argument(parser, "DEPTH", "Its depth, unless COLOUR has it: any of these",
                        options.depth);
  begin_group(parser, "Output");
  add_text(parser, "-o,--output", "FILE",
           "The result: .png, .exr, .pfm, .hdr or .npy; - for standard output (required)",
           options.output);
  add_format_option(parser, options.format);
  add_choice(parser, "--show", "The picture with depth of field, or a grey map (default: image)",
             kRefocusShows, options.show);
  add_flag(parser, "--no-layers", "From EXR to EXR: leave out the other layers that came in",
           [&options] { options.keep_layers = false; });
  add_flag(parser, "--json", "Print what was done as JSON on standard output", options.json);
  add_depth_options(parser, options.reading);
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
  add_goal_options(parser, options.goal);
  add_sequence_options(parser, options.sequence, "Of the frames only every N-th, from the I-th on");
  begin_group(parser, "Run");
  add_profile_option(parser, options.profile, options.profile_name);
  add_pool_options(parser, options.pool, "the picture is the same");
  add_talk_options(parser, options.verbose, options.quiet);
}

void complete(RefocusOptions& options, const CLI::App& parser) {
  check_talk(parser);
  settle_format(parser, options.output, options.format);
  const bool to_standard_output = options.output == "-";
  if (to_standard_output && options.json) {
    throw UsageError("--json and -o - would both write to standard output; give -o a file");
  }
  if (to_standard_output && is_terminal(kStandardOutput)) {
    throw UsageError("-o -: standard output is a terminal; send it to a file or a program");
  }
  check_photo_lens(parser);
  check_method(options);
  check_aperture(parser, options.method.name(), {});
  check_budget(parser, options.method.name());
  check_goal(parser, options.method);
  check_arithmetic(options.arithmetic, options.method.name(), false);
  if (options.highlights && options.arithmetic == Arithmetic::fixed_8) {
    throw UsageError(
        "--highlights and --arithmetic fixed-8 exclude each other: fixed-8 cuts what is brighter "
        "than white");
  }
}

}  // namespace softfocus

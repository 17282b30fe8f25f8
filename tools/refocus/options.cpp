#include "tools/refocus/options.h"

#include <array>

#include "tools/cli/errors.h"
#include "tools/cli/platform.h"

namespace softfocus {
namespace {

struct NamedShow {
  std::string_view name;
  RefocusShow show;
};
constexpr std::array kShows{NamedShow{"image", RefocusShow::image},
                            NamedShow{"coc", RefocusShow::coc},
                            NamedShow{"depth", RefocusShow::depth}};

constexpr std::array kBorders{Border::clamp, Border::mirror, Border::black};

void add_border_option(CLI::App& parser, Border& border) {
  add_value(parser, "--border", "clamp|mirror|black",
            "What the filter sees beyond the picture: its edge, its mirror image, nothing "
            "(default: the method's own, mostly clamp)",
            [&border](const std::string& text) {
              for (const Border known : kBorders) {
                if (name_of(known) != text) continue;
                border = known;
                return;
              }
              refuse_name("--border", text, {"clamp", "mirror", "black"});
            });
}

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
  add_value(parser, "-o,--output", "FILE",
            "The result: .png, .exr, .pfm, .hdr or .npy; - for standard output (required)",
            [&options](const std::string& text) { options.output = text; });
  add_format_option(parser, options.format);
  add_value(parser, "--show", "image|coc|depth",
            "The picture with depth of field, or a grey map (default: image)",
            [&options](const std::string& text) {
              for (const NamedShow& known : kShows) {
                if (known.name != text) continue;
                options.show = known.show;
                return;
              }
              refuse_name("--show", text, names_in(kShows));
            });
  add_flag(parser, "--no-layers", "From EXR to EXR: leave out the other layers that came in",
           [&options] { options.keep_layers = false; });
  add_flag(parser, "--json", "Print what was done as JSON on standard output", options.json);
  add_depth_options(parser, options.reading);
  add_photo_lens_options(parser, options.photo);
  begin_group(parser, "Bokeh");
  add_value(parser, "--aperture-blades", "N",
            "An aperture of 3 to 64 straight blades, 0 = round (default: 0)",
            [&blades = options.aperture.blades](const std::string& text) {
              blades = parse_blades("--aperture-blades", text);
            });
  add_aperture_options(parser, options.aperture);
  add_value(
      parser, "--highlights", "GAIN,THRESHOLD",
      "Raises what is brighter than THRESHOLD (white is 1), by GAIN for each step, while it is "
      "filtered: for lamps that were clipped",
      [&options](const std::string& text) { options.highlights = parse_highlights(text); });
  add_border_option(parser, options.border);
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
  for (const char* option : {"--max-error", "--max-time"}) {
    if (!is_given(parser, option) || options.method.is_auto()) continue;
    throw UsageError(std::string{option} + ": the method " + std::string{options.method.name()} +
                     " keeps to no bound; give --method auto");
  }
  if (is_given(parser, "--max-error") && is_given(parser, "--max-time")) {
    throw UsageError("--max-error and --max-time exclude each other; give one");
  }
  check_arithmetic(options.arithmetic, options.method.name(), false);
  if (options.highlights && options.arithmetic == Arithmetic::fixed_8) {
    throw UsageError(
        "--highlights and --arithmetic fixed-8 exclude each other: fixed-8 cuts what is brighter "
        "than white");
  }
}

}  // namespace softfocus

#include "tools/options/method_options.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "scenes/filtered_views/filtered_views.h"
#include "scenes/lens_views/shutter_times.h"
#include "scenes/warped_views/warped_views.h"
#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"

namespace softfocus {
namespace {

std::string given(Arithmetic arithmetic) {
  return "--arithmetic " + std::string{arithmetic_name(arithmetic)};
}

// Of Sampling::by_tile: the method's own.
constexpr int kMostUsual = 0;

// Of Sampling::shutter_frames, until the scene is there.
constexpr double kShutterOfScene = -1.0;

constexpr std::array kSamplingOptions{"--samples",         "--jitter",  "--until",
                                      "--aperture-blades", "--shutter", "--views"};

std::string names_of_methods_with_shutter() {
  std::string names;
  for (const LensViewMethod& method : lens_view_methods()) {
    if (method.has_shutter) names += (names.empty() ? "" : ", ") + std::string{method.name};
  }
  return names;
}

void refuse_shutter(const CLI::App& parser, std::string_view method) {
  if (!is_given(parser, "--shutter")) return;
  throw UsageError("--shutter: the method " + std::string{method} +
                   " shows one instant; give --method " + names_of_methods_with_shutter());
}

// Warped views are drawn from their points alone, and their number is known beforehand.
void check_warped_views(const CLI::App& parser, const LensViewMethod& method) {
  if (!method.warps_views) {
    if (!is_given(parser, "--views")) return;
    throw UsageError("--views: the method " + std::string{method.name} +
                     " draws all of its views; give --method warped-accumulation");
  }
  for (const char* option : {"--jitter", "--until"}) {
    if (!is_given(parser, option)) continue;
    throw UsageError(std::string{option} + ": the method " + std::string{method.name} +
                     " does without; give --method accumulation");
  }
}

}  // namespace

std::vector<std::string> all_methods() {
  std::vector<std::string> names = names_in(methods());
  const std::vector<std::string> of_scenes = names_in(lens_view_methods());
  names.insert(names.end(), of_scenes.begin(), of_scenes.end());
  names.emplace_back(kAutoMethod);
  return names;
}

void add_method_option(CLI::App& parser, const Method*& method) {
  add_value(parser, "--method", "NAME",
            "Depth-of-field method (default: " + std::string{method->name} + ")",
            [&method](const std::string& text) {
              method = find_method(text);
              if (method == nullptr) refuse_name("--method", text, names_in(methods()));
            });
  offer(parser, "--method", [] { return names_in(methods()); });
}

void add_method_option(CLI::App& parser, MethodChoice& method) {
  add_value(parser, "--method", "NAME",
            "Depth-of-field method (default: " + std::string{method.name()} + ")",
            [&method](const std::string& text) {
              method = {find_method(text), find_lens_view_method(text)};
              if (method.filter != nullptr || text == kAutoMethod) return;
              if (method.of_scene == nullptr) refuse_name("--method", text, all_methods());
              if (!method.of_scene->missing.empty()) {
                throw UsageError("--method " + text + ": " + std::string{method.of_scene->missing});
              }
            });
  offer(parser, "--method", all_methods);
}

void add_max_coc_option(CLI::App& parser, std::optional<float>& max_coc_px,
                        const std::string& standard) {
  add_value(parser, "--max-coc", "PIXELS",
            "Filter size: largest radius, 0 to 1024 (default: " + standard + ")",
            [&max_coc_px](const std::string& text) {
              max_coc_px = static_cast<float>(parse_number("--max-coc", text, 0.0, kLargestMaxCoc,
                                                           "a radius in pixels from 0 to 1024"));
            });
}

void add_weight_options(CLI::App& parser, float& leak, float& budget) {
  add_value(parser, "--leak", "A",
            "How readily a background gives its colour to what is before it (default: " +
                short_number(static_cast<double>(leak)) + ")",
            [&leak](const std::string& text) {
              leak = static_cast<float>(
                  parse_number("--leak", text, 0.0, 1e6, "a factor from 0 to 1000000"));
            });
  add_value(parser, "--budget", "SHARE",
            "Of importance-ordered: the share of one-pass's work to do, 0 to 1 (default: " +
                short_number(static_cast<double>(budget)) + ")",
            [&budget](const std::string& text) {
              budget = static_cast<float>(
                  parse_number("--budget", text, 0.0, 1.0, "a share from 0 to 1"));
            });
}

void check_budget(const CLI::App& parser, std::string_view method) {
  if (!is_given(parser, "--budget") || method == kBudgetMethod) return;
  throw UsageError("--budget: the method " + std::string{method} + " has none; give --method " +
                   std::string{kBudgetMethod});
}

float used_max_coc_px(std::optional<float> given, const SceneLens& of_scene, int height_px) {
  const double scaled = of_scene.max_coc_px_at_1024 * height_px / 1024.0;
  return given.value_or(static_cast<float>(std::fmin(scaled, static_cast<double>(kLargestMaxCoc))));
}

void add_arithmetic_option(CLI::App& parser, Arithmetic& arithmetic) {
  add_value(parser, "--arithmetic", "float|fixed|fixed-8",
            "Numbers that two-pass computes with: binary32, integers, integers on 8-bit colours "
            "(default: float)",
            [&arithmetic](const std::string& text) {
              for (const Arithmetic choice : arithmetics()) {
                if (arithmetic_name(choice) == text) {
                  arithmetic = choice;
                  return;
                }
              }
              refuse_name("--arithmetic", text, {"float", "fixed", "fixed-8"});
            });
}

void check_arithmetic(Arithmetic arithmetic, std::string_view method, bool on_driver) {
  if (arithmetic == Arithmetic::floats) return;
  if (method != "two-pass") {
    throw UsageError(given(arithmetic) + " and --method " + std::string{method} +
                     " exclude each other: only two-pass is there in integers");
  }
  if (on_driver) {
    throw UsageError(given(arithmetic) +
                     " and a GL driver exclude each other: drivers compute with floats");
  }
}

void check_arithmetic(Arithmetic arithmetic, const DofSettings& settings) {
  if (arithmetic == Arithmetic::floats) return;
  if (const char* error = fixed_settings_error(settings)) {
    throw UsageError(given(arithmetic) + ": " + error);
  }
}

int parse_blades(const char* option, const std::string& text) {
  constexpr const char* kWanted = "0 for a disc or a whole number from 3 to 64";
  const int blades = parse_whole(option, text, 0, kMostBlades, kWanted);
  if (blades == 1 || blades == 2) {
    throw UsageError(std::string{option} + " '" + text + "': give " + kWanted);
  }
  return blades;
}

void add_aperture_options(CLI::App& parser, Aperture& aperture) {
  add_value(parser, "--aperture-turn", "DEGREES",
            "Turns it counter-clockwise (default: 0, a corner up)",
            [&aperture](const std::string& text) {
              aperture.turn_degrees = static_cast<float>(parse_number(
                  "--aperture-turn", text, -360.0, 360.0, "an angle from -360 to 360 degrees"));
            });
  add_value(parser, "--anamorphic", "RATIO",
            "Height over width of what is out of focus, 1/16 to 16 (default: 1)",
            [&aperture](const std::string& text) {
              constexpr double kMost = static_cast<double>(kMostApertureStretch);
              aperture.stretch = static_cast<float>(
                  parse_number("--anamorphic", text, 1.0 / kMost, kMost,
                               "height over width from 0.0625 to 16, such as 2"));
            });
}

void check_aperture(const CLI::App& parser, std::string_view method, const std::string& others) {
  if (method == kApertureMethod) return;
  for (const char* option : {"--aperture-blades", "--aperture-turn", "--anamorphic"}) {
    if (!is_given(parser, option)) continue;
    const bool is_blades = option == std::string_view{"--aperture-blades"};
    throw UsageError(std::string{option} + ": the method " + std::string{method} +
                     " has a round aperture alone; give --method " + std::string{kApertureMethod} +
                     (is_blades && !others.empty() ? ", " + others : ""));
  }
}

Json aperture_json(const Aperture& aperture) {
  return {{"blades", aperture.blades},
          {"turn_degrees", aperture.turn_degrees},
          {"stretch", aperture.stretch}};
}

std::string names_of_sampling_methods() {
  std::string names;
  for (const LensViewMethod& method : lens_view_methods()) {
    if (!method.samples_lens) continue;
    names += (names.empty() ? "" : ", ") + std::string{method.name};
  }
  return names;
}

void add_sampling_options(CLI::App& parser, Sampling& sampling) {
  add_value(
      parser, "--samples", "N|auto[:N]",
      "Of accumulation, filtered-views, warped-accumulation and ray-traced: points on the lens, "
      "1 to 65536 "
      "(default: " +
          std::to_string(sampling.samples) + ", of filtered-views " +
          std::to_string(kFilteredViews) +
          ", with --until 65536); auto, not of ray-traced: as each tile needs, at most N "
          "(default: " +
          std::to_string(sampling.samples) + ", of filtered-views " +
          std::to_string(kMostFilteredViewsByTile) + ")",
      [&sampling](const std::string& text) {
        constexpr std::string_view kAutoWord = "auto", kAutoLimit = "auto:";
        sampling.by_tile = text == kAutoWord || text.starts_with(kAutoLimit);
        sampling.samples = kMostUsual;
        if (text == kAutoWord) return;
        sampling.samples =
            parse_whole("--samples", sampling.by_tile ? text.substr(kAutoLimit.size()) : text, 1,
                        kMostSamples, "a whole number from 1 to 65536, auto or auto:64");
      });
  add_value(
      parser, "--views", "V",
      "Of warped-accumulation: views that are drawn, 1 to 64; the others are warped from them "
      "(default: " +
          std::to_string(sampling.drawn_views) + ")",
      [&sampling](const std::string& text) {
        sampling.drawn_views =
            parse_whole("--views", text, 1, kMostDrawnViews, "a whole number from 1 to 64");
      });
  add_flag(parser, "--jitter",
           "Of the same: look from all over each pixel, not from its centre alone",
           sampling.jitter);
  add_value(parser, "--until", "ERROR",
            "Of the same: stop when two half-sets of samples differ by this RMS of linear values",
            [&sampling](const std::string& text) {
              sampling.until =
                  parse_number("--until", text, 1e-9, 1e9, "an error above 0, such as 0.001");
            });
  add_value(parser, "--shutter", "FRAMES",
            "Of accumulation: how long the shutter is open, 0 to 64 frames, with --frame in the "
            "middle (default: the scene's, mostly 0)",
            [&sampling](const std::string& text) {
              sampling.shutter_frames =
                  parse_number("--shutter", text, 0.0, kLongestShutter,
                               "a part of a frame's time from 0 to 64, such as 0.5");
            });
  add_value(
      parser, "--aperture-blades", "N",
      "Of the same and of scatter-aperture: an aperture of 3 to 64 straight blades, 0 = round "
      "(default: 0)",
      [&blades = sampling.aperture.blades](const std::string& text) {
        blades = parse_blades("--aperture-blades", text);
      });
}

void complete_sampling(Sampling& sampling, const LensViewMethod& method, const CLI::App& parser) {
  if (!method.has_shutter) refuse_shutter(parser, method.name);
  check_warped_views(parser, method);
  if (method.has_shutter && !is_given(parser, "--shutter")) {
    sampling.shutter_frames = kShutterOfScene;
  }
  if (sampling.by_tile) {
    if (method.usual_most_by_tile == 0) {
      throw UsageError("--samples auto: the method " + std::string{method.name} +
                       " takes the same number everywhere; give a number");
    }
    if (sampling.until) {
      throw UsageError(
          "--until and --samples auto exclude each other: auto stops in each tile by itself");
    }
    if (sampling.samples == kMostUsual) sampling.samples = method.usual_most_by_tile;
  }
  if (is_given(parser, "--samples")) return;
  sampling.samples = sampling.until ? kMostSamples : method.usual_samples;
}

Sampling with_shutter_of(const Scene& scene, Sampling sampling) {
  if (sampling.shutter_frames == kShutterOfScene) {
    sampling.shutter_frames = scene.camera.shutter_frames;
  }
  return sampling;
}

std::string shutter_warning(const Scene& scene, const MethodChoice& method,
                            const std::vector<ChosenEffect>& effects) {
  if (!(scene.camera.shutter_frames > 0.0)) return "";
  if (method.of_scene != nullptr && method.of_scene->has_shutter) return "";
  const bool is_blurred = std::any_of(effects.begin(), effects.end(), [](const ChosenEffect& of) {
    return of.effect->velocity != VelocityOf::nothing;
  });
  if (is_blurred) return "";
  return "the scene's shutter is open for " + short_number(scene.camera.shutter_frames) +
         " frames, and this is one instant; --effect motion-blur blurs what moves, --method " +
         names_of_methods_with_shutter() + " shows all of it";
}

void refuse_sampling_options(const CLI::App& parser, std::string_view method) {
  refuse_shutter(parser, method);
  for (const char* option : kSamplingOptions) {
    if (!is_given(parser, option)) continue;
    if (method == kApertureMethod && option == std::string_view{"--aperture-blades"}) continue;
    throw UsageError(std::string{option} + ": the method " + std::string{method} +
                     " does not sample the lens; give --method " + names_of_sampling_methods());
  }
}

void add_goal_options(CLI::App& parser, AutoGoal& goal) {
  add_value(parser, "--max-error", "E",
            "Of auto: the cheapest method whose mean FLIP should be at most this (default: " +
                short_number(goal.max_error) + ")",
            [&goal](const std::string& text) {
              goal.max_error = parse_number("--max-error", text, 0.0, 1.0,
                                            "a mean FLIP from 0 to 1, such as 0.02");
            });
  add_value(parser, "--max-time", "MS",
            "Of auto: the most accurate method that two cores of the reference machine should "
            "do in this time, beside drawing",
            [&goal](const std::string& text) {
              goal.max_time_ms = parse_number("--max-time", text, 0.0, 1e9,
                                              "a time in milliseconds of 0 or more, such as 8");
            });
}

void add_auto_options(CLI::App& parser, AutoGoal& goal, Verify& verify) {
  add_goal_options(parser, goal);
  add_flag(
      parser, "--verify",
      "Of auto: hold every choice by --max-error against views of the lens (default: where the "
      "predicted error is near the limit)",
      [&verify] { verify = Verify::always; });
  add_flag(parser, "--no-verify", "Of auto: hold none", [&verify] { verify = Verify::never; });
}

void check_auto_options(const CLI::App& parser, const MethodChoice& method) {
  if (is_given(parser, "--max-error") && is_given(parser, "--max-time")) {
    throw UsageError("--max-error and --max-time exclude each other; give one");
  }
  if (is_given(parser, "--verify") && is_given(parser, "--no-verify")) {
    throw UsageError("--verify and --no-verify exclude each other; give one");
  }
  if (is_given(parser, "--verify") && is_given(parser, "--max-time")) {
    throw UsageError("--verify holds the picture to --max-error; with --max-time leave it out");
  }
  for (const char* option : {"--max-error", "--max-time", "--verify", "--no-verify"}) {
    if (!is_given(parser, option) || method.is_auto()) continue;
    throw UsageError(std::string{option} + ": the method " + std::string{method.name()} +
                     " keeps to no bound; give --method auto");
  }
  if (!method.is_auto()) return;
  if (is_given(parser, "--gl")) {
    throw UsageError(
        "--gl and --method auto exclude each other: what auto may choose no driver can do; "
        "give a method");
  }
  for (const char* option : kSamplingOptions) {
    if (!is_given(parser, option)) continue;
    throw UsageError(std::string{option} +
                     ": the method auto settles by itself how the lens is sampled; "
                     "give --method accumulation");
  }
}

}  // namespace softfocus

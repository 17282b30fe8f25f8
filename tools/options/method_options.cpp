#include "tools/options/method_options.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "dof/parameters.h"
#include "dof/pipelines/pipeline.h"
#include "raster/numbers/parameter_text.h"
#include "scenes/filtered_views/filtered_views.h"
#include "scenes/load/pipeline_file.h"
#include "scenes/parameters.h"
#include "scenes/warped_views/warped_views.h"
#include "tools/cli/errors.h"
#include "tools/options/parameter_options.h"

namespace softfocus {
namespace {

std::string given(Arithmetic arithmetic) {
  return "--arithmetic " + std::string{arithmetic_name(arithmetic)};
}

// Stands for the method's own number with Sampling::by_tile.
constexpr int kMostUsual = 0;

// Stands in Sampling::shutter_frames until the scene is there.
constexpr double kShutterOfScene = -1.0;

constexpr std::initializer_list<const char*> kSamplingOptions{
    "--samples", "--jitter", "--until", "--aperture-blades", "--shutter", "--views"};

std::string names_of_methods_with_shutter() {
  std::string names;
  for (const LensViewMethod& method : lens_view_methods()) {
    if (method.has_shutter) names += (names.empty() ? "" : ", ") + std::string{method.name};
  }
  return names;
}

void refuse_shutter(const CLI::App& parser, std::string_view method) {
  refuse_given(parser, {"--shutter"},
               "the method " + std::string{method} + " shows one instant; give --method " +
                   names_of_methods_with_shutter());
}

// Warped views are drawn from their points alone, and their number is known beforehand.
void check_warped_views(const CLI::App& parser, const LensViewMethod& method) {
  if (!method.warps_views) {
    return refuse_given(parser, {"--views"},
                        "the method " + std::string{method.name} +
                            " draws all of its views; give --method warped-accumulation");
  }
  refuse_given(
      parser, {"--jitter", "--until"},
      "the method " + std::string{method.name} + " does without; give --method accumulation");
}

/// Of a command by name, with its dashes; empty of what is none.
std::vector<std::string> option_names(const CLI::App& program, const std::string& command) {
  std::vector<std::string> names;
  const CommandDescription all = describe(program, "");
  const bool is_command =
      std::any_of(all.commands.begin(), all.commands.end(),
                  [&](const CommandDescription& one) { return last_word(one.name) == command; });
  if (!is_command) return names;
  for (const OptionGroup& group : describe(program, command).groups) {
    for (const OptionDescription& option : group.options) {
      names.insert(names.end(), option.names.begin(), option.names.end());
    }
  }
  return names;
}

/// A list of methods with a parameter set for each that has it; nothing if none has.
std::optional<std::string> with_parameter(const std::string& list, const std::string& name,
                                          const std::string& value) {
  std::string made;
  bool is_taken = false;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    const std::string one = list.substr(begin, end - begin);
    begin = end + 1;
    made += (made.empty() ? "" : ",") + one;
    if (!is_pipeline_name(one)) continue;
    try {
      const std::vector<PipelineParameter>& all = pipeline_method(one)->pipeline->parameters;
      if (std::any_of(all.begin(), all.end(),
                      [&](const PipelineParameter& of) { return of.name == name; })) {
        made += ":" + name + "=" + value;
        is_taken = true;
      }
    } catch (const std::runtime_error&) {
      return {};  // the option will say it
    }
  }
  return is_taken ? std::optional{made} : std::nullopt;
}

}  // namespace

std::vector<std::string> with_parameters_joined(const CLI::App& program,
                                                std::vector<std::string> arguments) {
  const std::string command = arguments.empty() ? "" : arguments.front();
  std::vector<std::string> known;
  for (std::size_t i = 1; i < arguments.size() && arguments[i] != "--"; ++i) {
    const std::string& word = arguments[i];
    const std::size_t sign = std::min(word.find('='), word.size());
    const std::string option = word.substr(0, sign);
    if (!option.starts_with("--")) continue;
    if (known.empty()) known = option_names(program, command);
    if (known.empty()) break;
    if (std::find(known.begin(), known.end(), option) != known.end()) continue;
    const bool is_joined = sign < word.size();
    if (!is_joined && i + 1 == arguments.size()) break;
    const std::string name = option.substr(2);
    const std::string value = is_joined ? word.substr(sign + 1) : arguments[i + 1];
    std::vector<std::string> rest = arguments;
    const auto at = rest.begin() + static_cast<std::ptrdiff_t>(i);
    rest.erase(at, at + (is_joined ? 1 : 2));
    bool is_taken = false;
    for (std::size_t j = 1; j < rest.size(); ++j) {
      for (const std::string of : {"--method", "--methods", "--pipeline"}) {
        const bool is_before = rest[j - 1] == of;
        if (!is_before && !rest[j].starts_with(of + "=")) continue;
        const std::size_t begin = is_before ? 0 : of.size() + 1;
        const auto joined = with_parameter(rest[j].substr(begin), name, value);
        if (!joined) continue;
        is_taken = true;
        if (command != "apply") rest[j].replace(begin, rest[j].npos, *joined);
      }
    }
    if (!is_taken) continue;
    if (command == "apply") rest.insert(rest.begin() + 1, {"--set", name + "=" + value});
    arguments = std::move(rest);
    --i;
  }
  return arguments;
}

std::vector<std::string> all_methods() {
  std::vector<std::string> names = names_in(methods());
  const std::vector<std::string> of_scenes = names_in(lens_view_methods());
  names.insert(names.end(), of_scenes.begin(), of_scenes.end());
  names.emplace_back(kAutoMethod);
  return names;
}

MethodChoice find_named_method(const std::string& option, const std::string& name) {
  if (!is_pipeline_name(name)) return find_method_choice(name);
  try {
    const MethodChoice method = find_method_choice(name);
    for (const std::string& warning : warnings_of(*method.filter)) warn(warning);
    return method;
  } catch (const std::runtime_error& error) {
    throw UsageError(option + ": " + error.what());
  }
}

std::vector<std::string> listed_methods(const std::string& text,
                                        const std::vector<std::string>& known) {
  std::vector<std::string> names = listed_names("--methods", text);
  for (const std::string& name : names) {
    if (is_pipeline_name(name)) {
      find_named_method("--methods", name);
    } else if (std::find(known.begin(), known.end(), name) == known.end()) {
      refuse_name("--methods", name, known);
    }
  }
  return names;
}

void add_method_option(CLI::App& parser, const Method*& method) {
  add_value(parser, "--method", "NAME",
            "Depth-of-field method (default: " + std::string{method->name} + ")",
            [&method](const std::string& text) {
              method = find_named_method("--method", text).filter;
              if (method == nullptr) refuse_name("--method", text, names_in(methods()));
            });
  offer(parser, "--method", [] { return names_in(methods()); });
}

void add_method_option(CLI::App& parser, MethodChoice& method) {
  add_value(parser, "--method", "NAME",
            "Depth-of-field method (default: " + std::string{method.name()} +
                (method.name() == kDefaultMethod
                     ? "; two-pass with --gl, a driver's --profile, --arithmetic or --leak)"
                     : ")"),
            [&method](const std::string& text) {
              method = find_named_method("--method", text);
              if (method.filter != nullptr || text == kAutoMethod) return;
              if (method.of_scene == nullptr) refuse_name("--method", text, all_methods());
              if (!method.of_scene->missing.empty()) {
                throw UsageError("--method " + text + ": " + std::string{method.of_scene->missing});
              }
            });
  offer(parser, "--method", all_methods);
}

MethodChoice default_method(const CLI::App& parser, const Profile& profile) {
  const bool has_shaders = is_given(parser, "--gl") || is_given(parser, "--shaders");
  const bool has_own = is_given(parser, "--arithmetic") || is_given(parser, "--leak");
  return find_method_choice(has_shaders || has_own || profile != Profile{} ? "two-pass"
                                                                           : kDefaultMethod);
}

void add_max_coc_option(CLI::App& parser, std::optional<float>& max_coc_px,
                        const std::string& standard) {
  add_parameter(parser, parameter::kMaxCoc, standard, max_coc_px);
}

void add_weight_options(CLI::App& parser, float& leak, float& budget) {
  add_parameter(parser, parameter::kLeak, leak);
  add_parameter(parser, parameter::kBudget, budget);
}

void check_budget(const CLI::App& parser, std::string_view method) {
  if (method == kBudgetMethod) return;
  refuse_given(parser, {"--budget"},
               "the method " + std::string{method} + " has none; give --method " +
                   std::string{kBudgetMethod});
}

float used_max_coc_px(std::optional<float> given, const SceneLens& of_scene, int height_px) {
  const double scaled = of_scene.max_coc_px_at_1024 * height_px / 1024.0;
  return given.value_or(static_cast<float>(std::fmin(scaled, static_cast<double>(kLargestMaxCoc))));
}

void add_arithmetic_option(CLI::App& parser, Arithmetic& arithmetic) {
  std::vector<std::string> names;
  for (const Arithmetic known : arithmetics()) names.emplace_back(arithmetic_name(known));
  add_choice(parser, "--arithmetic",
             "Numbers that two-pass computes with: binary32, integers, integers on 8-bit colours "
             "(default: float)",
             names, [&arithmetic](std::size_t number) { arithmetic = arithmetics()[number]; });
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

void add_blades_option(CLI::App& parser, const std::string& help, int& blades) {
  static constexpr const Parameter& kBlades = parameter::kApertureBlades;
  add_value(parser, "--" + std::string{kBlades.name}, std::string{kBlades.type},
            help + " of 3 to 64 straight blades (default: 0, round)",
            [&blades](const std::string& text) {
              constexpr const char* kOption = "--aperture-blades";
              constexpr const char* kWanted = "0 for a disc or a whole number from 3 to 64";
              blades = parse_whole(kOption, text, 0, static_cast<int>(kBlades.most), kWanted);
              if (blades == 1 || blades == 2)
                parse_whole(kOption, text, 3, kMostApertureBlades, kWanted);
            });
}

void add_aperture_options(CLI::App& parser, Aperture& aperture) {
  add_parameter(parser, parameter::kApertureTurn, aperture.turn_degrees);
  add_parameter(parser, parameter::kAnamorphic, aperture.stretch);
}

void check_aperture(const CLI::App& parser, std::string_view method, const std::string& others) {
  if (method == kApertureMethod) return;
  const std::string why = "the method " + std::string{method} +
                          " has a round aperture alone; give --method " +
                          std::string{kApertureMethod};
  refuse_given(parser, {"--aperture-blades"}, why + (others.empty() ? "" : ", " + others));
  refuse_given(parser, {"--aperture-turn", "--anamorphic"}, why);
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
        const std::string number = sampling.by_tile ? text.substr(kAutoLimit.size()) : text;
        sampling.samples = parse_whole("--samples", number, 1, kMostSamples,
                                       wanted_text(parameter::kSamples) + ", auto or auto:64");
      });
  add_parameter(parser, parameter::kViews, sampling.drawn_views);
  add_flag(parser, "--jitter",
           "Not of warped-accumulation: look from all over each pixel, not from its centre alone",
           sampling.jitter);
  add_parameter(parser, parameter::kUntil, "", sampling.until);
  add_parameter(parser, parameter::kShutter, "the scene's, mostly 0", sampling.shutter_frames);
  add_blades_option(parser, "Of these methods and of scatter-aperture: an aperture",
                    sampling.aperture.blades);
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
  if (method.has_shutter()) return "";
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
    if (method == kApertureMethod && option == std::string_view{"--aperture-blades"}) continue;
    refuse_given(parser, {option},
                 "the method " + std::string{method} + " does not sample the lens; give --method " +
                     names_of_sampling_methods());
  }
}

void add_goal_options(CLI::App& parser, AutoGoal& goal) {
  add_parameter(parser, parameter::kMaxError, goal.max_error);
  add_parameter(parser, parameter::kMaxTime, "", goal.max_time_ms);
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

void check_goal(const CLI::App& parser, const MethodChoice& method) {
  check_one_of(parser, {"--max-error", "--max-time"});
  if (method.is_auto()) return;
  refuse_given(
      parser, {"--max-error", "--max-time", "--verify", "--no-verify"},
      "the method " + std::string{method.name()} + " keeps to no bound; give --method auto");
}

void check_auto_options(const CLI::App& parser, const MethodChoice& method) {
  check_goal(parser, method);
  check_one_of(parser, {"--verify", "--no-verify"});
  if (is_given(parser, "--verify") && is_given(parser, "--max-time")) {
    throw UsageError("--verify holds the picture to --max-error; with --max-time leave it out");
  }
  if (!method.is_auto()) return;
  if (is_given(parser, "--gl")) {
    throw UsageError(
        "--gl and --method auto exclude each other: what auto may choose no driver can do; "
        "give a method");
  }
  refuse_given(parser, kSamplingOptions,
               "the method auto settles by itself how the lens is sampled; "
               "give --method accumulation");
}

}  // namespace softfocus

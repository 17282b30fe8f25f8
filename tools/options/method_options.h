#pragma once
// The method and how it works: --method, --max-coc, --arithmetic, how the lens is sampled, and
// the limits of --method auto.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dof/parameters.h"
#include "scenes/frame/frame.h"
#include "scenes/warped_views/warped_views.h"
#include "tools/cli/parser.h"
#include "tools/files/json.h"

namespace softfocus {

namespace parameter {
// clang-format off
inline constexpr Parameter kSamples{"samples",
    "Points of the lens from which the scene is drawn: more are more exact and slower",
    1, kMostSamples, Sampling{}.samples, "", "N|auto[:N]", "", 1};
inline constexpr Parameter kViews{"views",
    "Of warped-accumulation: views that are drawn; the others are warped from them",
    1, kMostDrawnViews, Sampling{}.drawn_views, "", "V", "", 1};
inline constexpr Parameter kUntil{"until",
    "Not of warped-accumulation: stop when two half-sets of samples differ by this RMS of linear "
    "values",
    kNearlyNothing, kLargest, 0.0, "", "ERROR"};
// clang-format on
}  // namespace parameter

/// The method that DofSettings::budget bounds.
inline constexpr std::string_view kBudgetMethod = "importance-ordered";

/// The names of both tables, then `auto`.
std::vector<std::string> all_methods();

/// As find_method_choice(); tells the warnings of a pipeline. Throws UsageError for one that is at
/// fault.
MethodChoice find_named_method(const std::string& option, const std::string& name);

/// Of --methods, with a comma between two: `known` ones and pipelines.
std::vector<std::string> listed_methods(const std::string& text,
                                        const std::vector<std::string>& known);

/// Arguments in which `--NAME NUMBER`, an option that the command has not, but a parameter of a
/// pipeline that --method, --methods or --pipeline names, is said as that option says it:
/// "FILE.toml:NAME=NUMBER"; with `apply`, `--set NAME=NUMBER`.
std::vector<std::string> with_parameters_joined(const CLI::App& program,
                                                std::vector<std::string> arguments);

/// Adds --method for filters; `method` holds the default.
void add_method_option(CLI::App& parser, const Method*& method);

/// The same for both tables and for `auto`. What a build lacks is refused here, with how to get it.
void add_method_option(CLI::App& parser, MethodChoice& method);

/// What filters where no --method is named: the best of its price, for circles of any size.
inline constexpr std::string_view kDefaultMethod = "disc-layers";

/// two-pass if options ask for what it has alone: shaders, a driver's profile, integers, a leak.
/// Otherwise kDefaultMethod.
MethodChoice default_method(const CLI::App& parser, const Profile& profile);

/// Adds --max-coc. `standard` is the help's text for the default.
void add_max_coc_option(CLI::App& parser, std::optional<float>& max_coc_px,
                        const std::string& standard = "the scene's, by height");

/// Adds --leak and --budget, which hold their defaults.
void add_weight_options(CLI::App& parser, float& leak, float& budget);

/// Throws UsageError if --budget was given to a method that has none.
void check_budget(const CLI::App& parser, std::string_view method);

/// The filter size for a picture of that height: as given, or the scene's, at most
/// kLargestMaxCoc.
float used_max_coc_px(std::optional<float> given, const SceneLens& of_scene, int height_px);

void add_arithmetic_option(CLI::App& parser, Arithmetic& arithmetic);

/// Throws UsageError if a method has no other arithmetic than floats and another is wanted.
void check_arithmetic(Arithmetic arithmetic, std::string_view method, bool on_driver);

/// Throws UsageError for settings that integers cannot have.
void check_arithmetic(Arithmetic arithmetic, const DofSettings& settings);

/// Adds --aperture-blades: 0, or 3 to kMostApertureBlades.
void add_blades_option(CLI::App& parser, const std::string& help, int& blades);

/// Adds --aperture-turn and --anamorphic. The blades are an option of the sampling methods, too.
void add_aperture_options(CLI::App& parser, Aperture& aperture);

/// Throws UsageError if one of them or --aperture-blades was given and the method is another than
/// kApertureMethod. `others`: methods that have blades, for the message; or empty.
void check_aperture(const CLI::App& parser, std::string_view method, const std::string& others);

/// For notes and reports.
Json aperture_json(const Aperture& aperture);

std::string names_of_sampling_methods();

void add_sampling_options(CLI::App& parser, Sampling& sampling);

/// Once all options are read: without --samples, those of the method; with --until, kMostSamples.
/// Throws UsageError for --samples auto of a method that cannot, or with --until; or for --shutter
/// of a method that has none. with_shutter_of() must follow.
void complete_sampling(Sampling& sampling, const LensViewMethod& method, const CLI::App& parser);

/// With the scene's shutter if the method has one and --shutter was not given.
Sampling with_shutter_of(const Scene& scene, Sampling sampling);

/// A warning if the scene suggests an open shutter, but the method and the effects show one
/// instant, or "".
std::string shutter_warning(const Scene& scene, const MethodChoice& method,
                            const std::vector<ChosenEffect>& effects);

/// Throws UsageError if one of them was given, for a filter does not sample the lens; but for
/// --aperture-blades of kApertureMethod.
void refuse_sampling_options(const CLI::App& parser, std::string_view method);

/// Adds --max-error and --max-time.
void add_goal_options(CLI::App& parser, AutoGoal& goal);

/// Throws UsageError if both were given, or either of a method that keeps to no bound.
void check_goal(const CLI::App& parser, const MethodChoice& method);

/// Adds them, --verify and --no-verify.
void add_auto_options(CLI::App& parser, AutoGoal& goal, Verify& verify);

/// Throws UsageError if both were given, or either without --method auto, or with it an
/// option that it settles itself.
void check_auto_options(const CLI::App& parser, const MethodChoice& method);

}  // namespace softfocus

#include "tools/options/auto_options.h"

#include <array>

#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"

namespace softfocus {

void add_auto_options(CLI::App& parser, AutoGoal& goal) {
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

void check_auto_options(const CLI::App& parser, const MethodChoice& method) {
  if (is_given(parser, "--max-error") && is_given(parser, "--max-time")) {
    throw UsageError("--max-error and --max-time exclude each other; give one");
  }
  for (const char* option : {"--max-error", "--max-time"}) {
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
  for (const char* option : {"--samples", "--until", "--jitter", "--aperture-blades"}) {
    if (!is_given(parser, option)) continue;
    throw UsageError(std::string{option} +
                     ": the method auto settles by itself how the lens is sampled; "
                     "give --method accumulation");
  }
}

}  // namespace softfocus

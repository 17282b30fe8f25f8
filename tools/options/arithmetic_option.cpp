#include "tools/options/arithmetic_option.h"

#include <string>

#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"

namespace softfocus {
namespace {

std::string given(Arithmetic arithmetic) {
  return "--arithmetic " + std::string{arithmetic_name(arithmetic)};
}

}  // namespace

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
              throw UsageError("--arithmetic '" + text + "': there are float, fixed, fixed-8");
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

}  // namespace softfocus

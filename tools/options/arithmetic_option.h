#pragma once
// --arithmetic, as `render` and `bench` share it.

#include <string_view>

#include "dof/fixed_pictures/arithmetic.h"
#include "tools/cli/parser.h"

namespace softfocus {

void add_arithmetic_option(CLI::App& parser, Arithmetic& arithmetic);

/// Throws UsageError if a method has no other arithmetic than floats and another is wanted.
void check_arithmetic(Arithmetic arithmetic, std::string_view method, bool on_driver);

/// Throws UsageError for settings that integers cannot have.
void check_arithmetic(Arithmetic arithmetic, const DofSettings& settings);

}  // namespace softfocus

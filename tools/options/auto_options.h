#pragma once
// --max-error and --max-time: what `--method auto` is to keep to.

#include "dof/auto/auto_method.h"
#include "tools/options/method_options.h"
#include "tools/cli/parser.h"

namespace softfocus {

void add_auto_options(CLI::App& parser, AutoGoal& goal);

/// Throws UsageError if both were given, or either without --method auto, or with it an
/// option that it settles itself.
void check_auto_options(const CLI::App& parser, const MethodChoice& method);

}  // namespace softfocus

#pragma once
// The table of subcommands. Adding one touches its own file, this list and main.cpp.

#include <functional>

#include "tools/cli/parser.h"

namespace softfocus {

/// Exit statuses. `compare` and `crosscheck` have diff's: 0 equal, 1 different, 2 error.
inline constexpr int kDone = 0;
inline constexpr int kFailed = 1;
inline constexpr int kWrongUsage = 2;

/// A subcommand: its parser, and its work, which returns the exit status.
struct Command {
  CLI::App* parser;
  std::function<int()> work;
};

Command add_render_command(CLI::App& program);
Command add_join_command(CLI::App& program);
Command add_refocus_command(CLI::App& program);
Command add_apply_command(CLI::App& program);
Command add_inspect_command(CLI::App& program);
Command add_scenes_command(CLI::App& program);
Command add_methods_command(CLI::App& program);
Command add_effects_command(CLI::App& program);
Command add_candidates_command(CLI::App& program);
Command add_profiles_command(CLI::App& program);
Command add_lens_command(CLI::App& program);
Command add_compare_command(CLI::App& program);
Command add_crosscheck_command(CLI::App& program);
Command add_probe_command(CLI::App& program);
Command add_shaders_command(CLI::App& program);
Command add_bench_command(CLI::App& program);
Command add_shadows_command(CLI::App& program);
Command add_relief_command(CLI::App& program);
Command add_chart_command(CLI::App& program);
Command add_stress_command(CLI::App& program);
Command add_golden_command(CLI::App& program);
Command add_selftest_command(CLI::App& program);
Command add_help_command(CLI::App& program);
Command add_documentation_command(CLI::App& program);

}  // namespace softfocus

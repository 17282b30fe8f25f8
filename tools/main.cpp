// The program: the list of its commands.

#include "tools/cli/interrupts.h"
#include "tools/cli/platform.h"
#include "tools/program.h"

namespace softfocus {
namespace {

std::vector<Command> add_commands(CLI::App& program) {
  return {add_render_command(program),     add_join_command(program),
          add_refocus_command(program),    add_apply_command(program),
          add_inspect_command(program),    add_scenes_command(program),
          add_methods_command(program),    add_effects_command(program),
          add_candidates_command(program), add_profiles_command(program),
          add_lens_command(program),       add_compare_command(program),
          add_crosscheck_command(program), add_probe_command(program),
          add_shaders_command(program),    add_bench_command(program),
          add_shadows_command(program),    add_relief_command(program),
          add_chart_command(program),      add_stress_command(program),
          add_golden_command(program),     add_selftest_command(program),
          add_help_command(program),       add_documentation_command(program)};
}

}  // namespace
}  // namespace softfocus

int main(int argc, char** argv) {
  softfocus::prepare_process();
  softfocus::prepare_interrupts();
  return softfocus::run_program(softfocus::add_commands, {argv + 1, argv + argc});
}

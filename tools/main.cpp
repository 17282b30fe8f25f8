// The program: the list of its commands, and what becomes of an error.

#include <iostream>
#include <new>

#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/cli/interrupts.h"
#include "tools/cli/platform.h"
#include "tools/gl/driver/driver.h"
#include "tools/options/method_options.h"
#include "tools/render/options.h"

namespace softfocus {
namespace {

int report(std::string_view message, int status) {
  tell(message);
  return status;
}

/// A status, unless standard output could not take all that was written. A reader such as `head`
/// that needs no more is no failure.
int finish(int status, int failed) {
  std::cout.flush();
  if (!std::cout && !is_reader_gone(kStandardOutput))
    return report("standard output: not everything could be written", failed);
  return status;
}

int run_command(const Command& command) {
  // Commands that compare say "different" with 1: any error there is a 2.
  const std::string name = name_of(*command.parser);
  const bool compares = name == "compare" || name == "crosscheck" || name == "golden";
  const int failed = compares ? kWrongUsage : kFailed;
  try {
    return finish(command.work(), failed);
  } catch (const UsageError& error) {
    return report(error.what(), kWrongUsage);
  } catch (const DriverError& error) {  // it cannot run here
    return report(error.what(), kWrongUsage);
  } catch (const std::bad_alloc&) {
    return report(
        "out of memory; a smaller picture, smaller shadow maps or coarser meshes need less",
        failed);
  } catch (const std::exception& error) {
    return report(error.what(), failed);
  }
}

int run(std::vector<std::string> arguments) {
  const auto program =
      make_program("softfocus", SOFTFOCUS_VERSION, "Renders scenes with depth of field.");
  const std::vector<Command> commands{
      add_render_command(*program),     add_join_command(*program),
      add_refocus_command(*program),    add_apply_command(*program),
      add_inspect_command(*program),    add_scenes_command(*program),
      add_methods_command(*program),    add_effects_command(*program),
      add_candidates_command(*program), add_profiles_command(*program),
      add_lens_command(*program),       add_compare_command(*program),
      add_crosscheck_command(*program), add_probe_command(*program),
      add_shaders_command(*program),    add_bench_command(*program),
      add_shadows_command(*program),    add_relief_command(*program),
      add_chart_command(*program),      add_stress_command(*program),
      add_golden_command(*program),     add_selftest_command(*program),
      add_help_command(*program),       add_documentation_command(*program)};
  try {
    arguments = with_autofocus_joined(std::move(arguments));
    const Parsed parsed = parse(*program, with_parameters_joined(*program, std::move(arguments)));
    if (parsed.answered) return finish(kDone, kFailed);
    for (const Command& command : commands) {
      if (command.parser == parsed.command) return run_command(command);
    }
  } catch (const UsageError& error) {
    return report(error.what(), kWrongUsage);
  }
  return kWrongUsage;
}

}  // namespace
}  // namespace softfocus

int main(int argc, char** argv) {
  softfocus::prepare_process();
  softfocus::prepare_interrupts();
  return softfocus::run({argv + 1, argv + argc});
}

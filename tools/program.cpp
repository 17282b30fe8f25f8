#include "tools/program.h"

#include <iostream>
#include <new>
#include <utility>

#include "tools/cli/errors.h"
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

}  // namespace

int run_program(const std::function<std::vector<Command>(CLI::App&)>& add,
                std::vector<std::string> words) {
  const auto program =
      make_program("softfocus", SOFTFOCUS_VERSION, "Renders scenes with depth of field.");
  const std::vector<Command> commands = add(*program);
  try {
    words = with_autofocus_joined(std::move(words));
    const Parsed parsed = parse(*program, with_parameters_joined(*program, std::move(words)));
    if (parsed.answered) return finish(kDone, kFailed);
    for (const Command& command : commands) {
      if (command.parser == parsed.command) return run_command(command);
    }
  } catch (const UsageError& error) {
    return report(error.what(), kWrongUsage);
  }
  return kWrongUsage;
}

}  // namespace softfocus

#include "tools/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <new>
#include <string_view>

#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/render/options.h"

namespace softfocus {
namespace {

/// One line whatever the message holds: a file's name may contain a newline.
int report(std::string message, int status) {
  for (char& c : message) {
    const auto code = static_cast<unsigned char>(c);
    if (code < 0x20 || code == 0x7F) c = '?';
  }
  std::cerr << "softfocus: " << message << '\n';
  return status;
}

std::string names(const std::vector<Command>& commands) {
  std::string list;
  for (const Command& command : commands) {
    list += (list.empty() ? "" : ", ") + command.parser->get_name();
  }
  return list;
}

/// Throws for the arguments that the parser had no place for.
void check_rest(const CLI::App& program, const std::vector<Command>& commands) {
  const auto rest = program.remaining(true);
  if (rest.empty()) return;
  const auto parsed = program.get_subcommands();
  const bool is_option = rest.front().starts_with('-');
  if (!is_option && (parsed.empty() || !program.remaining(false).empty())) {
    throw UsageError("unknown command '" + rest.front() + "'; there are " + names(commands));
  }
  const std::string help =
      "softfocus " + (parsed.empty() ? "" : parsed.front()->get_name() + " ") + "--help";
  throw UsageError((is_option ? "unknown option '" : "unexpected argument '") + rest.front() +
                   "'; " + help + " lists what there is");
}

/// CLI11's own complaints in this program's words: an option without its value, a
/// missing argument.
std::string reworded(const CLI::ParseError& error) {
  const std::string message = error.what();
  if (error.get_name() == "ArgumentMismatch") {
    return message.substr(0, message.find(':')) + " needs a value; --help says which";
  }
  if (error.get_name() == "RequiredError") {
    return message.substr(0, message.find(' ')) + " is missing; --help says what to give";
  }
  return message;
}

int run_command(const Command& command) {
  // Where things are compared, 1 means "different": any error there is a 2.
  const std::string name = command.parser->get_name();
  const int failed = name == "compare" || name == "crosscheck" ? kWrongUsage : kFailed;
  try {
    const int status = command.work();
    std::cout.flush();
    if (!std::cout) return report("standard output: not everything could be written", failed);
    return status;
  } catch (const UsageError& error) {
    return report(error.what(), kWrongUsage);
  } catch (const std::bad_alloc&) {
    return report("out of memory; a smaller picture needs less", failed);
  } catch (const std::exception& error) {
    return report(error.what(), failed);
  }
}

}  // namespace

int run(std::vector<std::string> arguments) {
  CLI::App program{"Renders scenes with depth of field.", "softfocus"};
  program.set_version_flag("--version", "softfocus " SOFTFOCUS_VERSION);
  program.require_subcommand(0, 1);
  program.get_formatter()->column_width(26);
  const std::vector<Command> commands{
      add_render_command(program),     add_scenes_command(program), add_methods_command(program),
      add_profiles_command(program),   add_lens_command(program),   add_compare_command(program),
      add_crosscheck_command(program), add_probe_command(program),  add_shaders_command(program),
      add_bench_command(program),      add_chart_command(program),  add_selftest_command(program)};
  // What is left over is ours to complain about, in check_rest().
  program.allow_extras();
  for (const Command& command : commands) command.parser->allow_extras();

  arguments = with_autofocus_joined(std::move(arguments));
  std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes them
  try {
    try {
      program.parse(std::move(arguments));
    } catch (const CLI::RequiredError&) {
      // What is missing may stand there misspelt.
      check_rest(program, commands);
      throw;
    }
    check_rest(program, commands);
  } catch (const CLI::Success& request) {  // --help or --version
    program.exit(request);
    std::cout.flush();
    return std::cout ? kDone : report("standard output: not everything could be written", kFailed);
  } catch (const CLI::ParseError& error) {
    return report(reworded(error), kWrongUsage);
  } catch (const UsageError& error) {
    return report(error.what(), kWrongUsage);
  }
  for (const Command& command : commands) {
    if (command.parser->parsed()) return run_command(command);
  }
  std::cerr << program.help();
  return kWrongUsage;
}

}  // namespace softfocus

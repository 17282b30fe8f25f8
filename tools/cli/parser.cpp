#include "tools/cli/parser.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <utility>

#include "tools/cli/errors.h"

namespace softfocus {
namespace {

/// Throws for the arguments that the parser had no place for.
void check_rest(const CLI::App& program) {
  const auto rest = program.remaining(true);
  if (rest.empty()) return;
  const auto parsed = program.get_subcommands();
  const bool is_option = rest.front().starts_with('-');
  if (!is_option && (parsed.empty() || !program.remaining(false).empty())) {
    std::string names;
    for (const CLI::App* command : program.get_subcommands({})) {
      names += (names.empty() ? "" : ", ") + command->get_name();
    }
    throw UsageError("unknown command '" + rest.front() + "'; there are " + names);
  }
  const std::string help =
      "softfocus " + (parsed.empty() ? "" : parsed.front()->get_name() + " ") + "--help";
  throw UsageError((is_option ? "unknown option '" : "unexpected argument '") + rest.front() +
                   "'; " + help + " lists what there is");
}

/// CLI11's own complaints in this program's words: an option without its value, a
/// missing argument.
std::string reworded(const CLI::ParseError& error) {
  std::string message = error.what();
  if (error.get_name() == "ArgumentMismatch") {
    return message.substr(0, message.find(':')) + " needs a value; --help says which";
  }
  if (error.get_name() == "RequiredError") {
    return message.substr(0, message.find(' ')) + " is missing; --help says what to give";
  }
  return message;
}

}  // namespace

std::shared_ptr<CLI::App> make_program(const std::string& name, const std::string& version,
                                       const std::string& help) {
  auto program = std::make_shared<CLI::App>(help, name);
  program->set_version_flag("--version", name + " " + version);
  program->require_subcommand(0, 1);
  program->get_formatter()->column_width(26);
  return program;
}

Parsed parse(CLI::App& program, std::vector<std::string> arguments) {
  // Left-over arguments are refused in check_rest().
  program.allow_extras();
  for (CLI::App* command : program.get_subcommands({})) command->allow_extras();
  std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes them
  try {
    try {
      program.parse(std::move(arguments));
    } catch (const CLI::RequiredError&) {
      // What is missing may stand there misspelt.
      check_rest(program);
      throw;
    }
    check_rest(program);
  } catch (const CLI::Success& request) {
    program.exit(request);
    return {nullptr, true};
  } catch (const CLI::ParseError& error) {
    throw UsageError(reworded(error));
  }
  const auto commands = program.get_subcommands();
  if (!commands.empty()) return {commands.front(), false};
  std::cerr << program.help();
  return {nullptr, false};
}

std::string name_of(const CLI::App& command) { return command.get_name(); }

CLI::App* add_command(CLI::App& program, const std::string& name, const std::string& help) {
  return program.add_subcommand(name, help);
}

void add_flag(CLI::App& parser, const std::string& name, const std::string& help, bool& given) {
  parser.add_flag(name, given, help);
}

void add_flag(CLI::App& parser, const std::string& name, const std::string& help,
              std::function<void()> take) {
  parser.add_flag_callback(name, std::move(take), help);
}

void add_value(CLI::App& parser, const std::string& name, const std::string& type,
               const std::string& help, std::function<void(const std::string&)> take) {
  const std::string shown = name.substr(0, name.find(','));
  const auto take_once = [shown, take = std::move(take)](const CLI::results_t& values) {
    if (values.size() > 1) throw UsageError(shown + " is given twice; give it once");
    // CLI11 takes whatever comes next for the value.
    if (values.front().starts_with("--")) {
      throw UsageError(shown + " needs a value and is followed by '" + values.front() + "'");
    }
    take(values.front());
    return true;
  };
  parser.add_option(name, take_once, help)
      ->type_name(type)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void add_repeatable_value(CLI::App& parser, const std::string& name, const std::string& type,
                          const std::string& help, std::function<void(const std::string&)> take) {
  const auto take_each = [take = std::move(take)](const CLI::results_t& values) {
    for (const std::string& value : values) take(value);
    return true;
  };
  parser.add_option(name, take_each, help)
      ->type_name(type)
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void add_value_list(CLI::App& parser, const std::string& name, const std::string& type,
                    const std::string& help,
                    std::function<void(const std::vector<std::string>&)> take) {
  parser.add_option_function<std::vector<std::string>>(name, std::move(take), help)
      ->type_name(type);
}

void add_argument(CLI::App& parser, const std::string& name, const std::string& help,
                  std::string& value) {
  parser.add_option(name, value, help)->type_name("")->required();
}

void add_optional_argument(CLI::App& parser, const std::string& name, const std::string& help,
                           std::string& value) {
  parser.add_option(name, value, help)->type_name("");
}

std::string given_text(const CLI::App& parser, std::span<const std::string_view> without) {
  std::string text;
  for (const CLI::Option* option : parser.get_options()) {
    const bool left_out = option->count() == 0 ||
                          std::any_of(without.begin(), without.end(), [&](std::string_view name) {
                            return option->check_name(std::string{name});
                          });
    if (left_out) continue;
    text += option->get_name();
    for (const std::string& value : option->results()) text += "=" + value;
    text += "\n";
  }
  return text;
}

bool is_given(const CLI::App& parser, const std::string& option) {
  const CLI::Option* found = parser.get_option_no_throw(option);
  return found != nullptr && found->count() != 0;
}

}  // namespace softfocus

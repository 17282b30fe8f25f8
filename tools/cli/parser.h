#pragma once
// How commands describe their options. Only parser.cpp includes CLI11, whose headers take
// seconds to compile.

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/cli/command_description.h"

namespace CLI {  // NOLINT(readability-identifier-naming)
class App;
}

namespace softfocus {

/// The program's parser, with --help and --version.
std::shared_ptr<CLI::App> make_program(const std::string& name, const std::string& version,
                                       const std::string& help);

/// The command that the arguments ask for.
struct Parsed {
  CLI::App* command;  ///< or nullptr: there was none, or --help or --version was answered
  bool answered;
};

/// Reads the arguments, without the program's name. Without any, the help is printed on standard
/// error. Words behind `--` are no options. Throws UsageError.
Parsed parse(CLI::App& program, std::vector<std::string> arguments);

std::string name_of(const CLI::App& command);

/// The description of a command of the program; of the program itself if `command` is empty.
/// Throws UsageError if there is no such command.
CommandDescription describe(const CLI::App& program, const std::string& command);

/// Adds a command to the program. The program owns its parser.
CLI::App* add_command(CLI::App& program, const std::string& name, const std::string& help);

/// Adds a command that no list of commands shows.
CLI::App* add_hidden_command(CLI::App& program, const std::string& name, const std::string& help);

/// The heading of --help, which stands last.
inline constexpr const char* kGeneralGroup = "General";

/// The heading in the help for all options that are added from here on. Headings stand in the
/// order in which they first come; more options can be added to one later.
void begin_group(CLI::App& parser, const std::string& heading);

/// Adds an option without a value, which sets `given`.
void add_flag(CLI::App& parser, const std::string& name, const std::string& help, bool& given);

/// Adds an option without a value, which does more than set a variable.
void add_flag(CLI::App& parser, const std::string& name, const std::string& help,
              std::function<void()> take);

/// Adds an option that takes one value and may be given once. `type` stands for the
/// value in the help; `take` gets the text and throws UsageError.
void add_value(CLI::App& parser, const std::string& name, const std::string& type,
               const std::string& help, std::function<void(const std::string&)> take);

/// Adds an option that may be given often: `take` gets one text after the other.
void add_repeatable_value(CLI::App& parser, const std::string& name, const std::string& type,
                          const std::string& help, std::function<void(const std::string&)> take);

/// Adds an option that takes all values up to the next option.
void add_value_list(CLI::App& parser, const std::string& name, const std::string& type,
                    const std::string& help,
                    const std::function<void(const std::vector<std::string>&)>& take);

/// A positional argument that must be given.
void add_argument(CLI::App& parser, const std::string& name, const std::string& help,
                  std::string& value);

/// A positional argument that need not be given.
void add_optional_argument(CLI::App& parser, const std::string& name, const std::string& help,
                           std::string& value);

/// Positional arguments, any number of them.
void add_optional_arguments(CLI::App& parser, const std::string& name, const std::string& help,
                            std::vector<std::string>& values);

/// Names what the value of an option or argument can be, for completions and man pages. A type
/// such as `image|coc|depth` says it already.
void offer(CLI::App& parser, const std::string& option, Choices choices);

/// All options and arguments that are on the command line that was parsed, with their values, but
/// those of these names; in the order in which the command has them.
std::string given_text(const CLI::App& parser, std::span<const std::string_view> without);

/// Whether an option, by one of its names, is on the command line that was parsed; false for one
/// that the command does not have.
bool is_given(const CLI::App& parser, const std::string& option);

}  // namespace softfocus

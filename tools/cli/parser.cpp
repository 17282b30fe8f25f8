#include "tools/cli/parser.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <iterator>
#include <map>
#include <type_traits>
#include <utility>

#include "scenes/files/scene_error.h"
#include "tools/cli/errors.h"
#include "tools/cli/platform.h"

namespace softfocus {
namespace {

/// CLI11's parser, and what it has no place for.
class Program final : public CLI::App {
 public:
  using App::App;
  std::map<const CLI::Option*, Choices> choices;
};

/// The program that a command belongs to.
template <class App>
auto& root_of(App& command) {
  App* root = &command;
  while (root->get_parent() != nullptr) root = root->get_parent();
  using Root = std::conditional_t<std::is_const_v<App>, const Program, Program>;
  return static_cast<Root&>(*root);
}

// Stands for `--`, which CLI11 does not take after all arguments that must be given, and which it
// lets end a list of values alone.
constexpr const char* kEndOfOptions = "--end-of-options";

bool is_hidden(const CLI::App& command) { return command.get_group().empty(); }

std::vector<std::string> command_names(const CLI::App& program) {
  std::vector<std::string> names;
  for (const CLI::App* command : program.get_subcommands({})) {
    if (!is_hidden(*command)) names.push_back(command->get_name());
  }
  return names;
}

[[noreturn]] void refuse_command(const CLI::App& program, const std::string& name) {
  const std::vector<std::string> there = command_names(program);
  std::string list;
  for (const std::string& one : there) list += (list.empty() ? "" : ", ") + one;
  throw UsageError("unknown command '" + name + "'; there are " + list + did_you_mean(name, there));
}

/// "image", "coc", "depth" of "image|coc|depth": what a type names by itself.
std::vector<std::string> words_of_type(const std::string& type) {
  if (type.find('|') == type.npos ||
      type.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-|") != type.npos) {
    return {};
  }
  std::vector<std::string> words{""};
  for (const char c : type) {
    if (c == '|') {
      words.emplace_back();
    } else {
      words.back() += c;
    }
  }
  return words;
}

OptionDescription described(const CLI::Option& option, const Program& program) {
  OptionDescription known{.help = option.get_description(), .is_required = option.get_required()};
  if (option.get_positional()) {
    known.names = {option.get_name(true)};
  } else {
    for (const std::string& name : option.get_snames()) known.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) known.names.push_back("--" + name);
  }
  known.is_list = option.get_expected_max() >= CLI::detail::expected_max_vector_size;
  if (option.get_items_expected_max() > 0) known.type = option.get_type_name();
  if (known.is_list && !option.get_positional()) known.type += " ...";
  const auto offered = program.choices.find(&option);
  if (offered != program.choices.end()) {
    known.choices = offered->second;
  } else if (auto words = words_of_type(known.type); !words.empty()) {
    known.choices = [words = std::move(words)] { return words; };
  }
  return known;
}

CommandDescription described(const CLI::App& command, const Program& program) {
  const bool is_program = command.get_parent() == nullptr;
  CommandDescription known{
      .name = is_program ? command.get_name() : program.get_name() + " " + command.get_name(),
      .help = command.get_description()};
  OptionGroup general{kGeneralGroup, {}};
  for (const CLI::Option* option : command.get_options()) {
    const std::string& group = option->get_group();
    if (option->get_positional()) {
      known.arguments.push_back(described(*option, program));
    } else if (group == kGeneralGroup) {
      general.options.push_back(described(*option, program));
    } else if (!group.empty()) {
      auto found = std::find_if(known.groups.begin(), known.groups.end(),
                                [&](const OptionGroup& one) { return one.name == group; });
      if (found == known.groups.end()) {
        found = known.groups.insert(found, OptionGroup{group, {}});
      }
      found->options.push_back(described(*option, program));
    }
  }
  known.groups.push_back(std::move(general));
  for (const CLI::App* one : command.get_subcommands({})) {
    if (!is_hidden(*one)) known.commands.push_back(described(*one, program));
  }
  return known;
}

/// The program, or the command that was recognised.
const CLI::App& parsed_command(const CLI::App& program) {
  const auto commands = program.get_subcommands();
  return commands.empty() ? program : *commands.front();
}

/// "softfocus render --help".
std::string help_of(const CLI::App& command) {
  const bool is_program = command.get_parent() == nullptr;
  return "softfocus " + (is_program ? "" : command.get_name() + " ") + "--help";
}

/// Throws for the arguments that the parser had no place for.
void check_rest(const CLI::App& program) {
  const auto rest = program.remaining(true);
  if (rest.empty()) return;
  const CLI::App& command = parsed_command(program);
  const std::string& first = rest.front();
  const bool is_option = first.starts_with('-');
  if (!is_option && (&command == &program || !program.remaining(false).empty())) {
    refuse_command(program, first);
  }
  const std::string help = help_of(command);
  if (!is_option) {
    throw UsageError("unexpected argument '" + first + "'; " + help + " lists what there is");
  }
  std::vector<std::string> there;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) there.push_back("--" + name);
  }
  const std::string name = first.substr(0, first.find('='));
  throw UsageError("unknown option '" + first + "'; " + help + " lists what there is" +
                   did_you_mean(name, there));
}

/// Arguments in which nothing after `--` looks like an option: files get a folder before their
/// name. `-` stays standard output.
std::vector<std::string> with_options_ended(std::vector<std::string> arguments) {
  const auto end = std::find(arguments.begin(), arguments.end(), "--");
  if (end == arguments.end()) return arguments;
  *end = kEndOfOptions;
  for (auto after = std::next(end); after != arguments.end(); ++after) {
    if (after->size() > 1 && after->starts_with('-')) after->insert(0, "./");
  }
  return arguments;
}

/// CLI11's own complaints in this program's words: an option without its value, a
/// missing argument.
std::string reworded(const CLI::ParseError& error, const std::string& help) {
  std::string message = error.what();
  const std::string option = message.substr(0, message.find_first_of(": "));
  if (error.get_name() == "ArgumentMismatch") {
    if (message.ends_with("flag override")) {  // of which it tells the name without dashes
      return (option.size() > 1 ? "--" : "-") + option + " takes no value";
    }
    return option + " needs a value; " + help + " says which";
  }
  if (error.get_name() == "RequiredError") {
    return option + " is missing; " + help + " says what to give";
  }
  return message;
}

}  // namespace

std::shared_ptr<CLI::App> make_program(const std::string& name, const std::string& version,
                                       const std::string& help) {
  auto program = std::make_shared<Program>(help, name);
  program->set_help_flag("-h,--help", "Print this help");
  program->set_version_flag("-V,--version", name + " " + version, "Print the version");
  program->require_subcommand(0, 1);
  for (CLI::Option* option : program->get_options()) option->group(kGeneralGroup);
  program->add_flag(kEndOfOptions)->group("");
  return program;
}

Parsed parse(CLI::App& program, std::vector<std::string> arguments) {
  // Left-over arguments are refused in check_rest().
  program.allow_extras();
  for (CLI::App* command : program.get_subcommands({})) command->allow_extras();
  arguments = with_options_ended(std::move(arguments));
  std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes them
  const auto help_for = [](const CLI::App& command, int descriptor) {
    return help_text(described(command, root_of(command)), columns_of(descriptor));
  };
  try {
    try {
      program.parse(std::move(arguments));
    } catch (const CLI::RequiredError&) {
      // The missing word may stand there misspelt.
      check_rest(program);
      throw;
    }
    check_rest(program);
  } catch (const CLI::CallForHelp&) {
    std::cout << help_for(parsed_command(program), kStandardOutput);
    return {nullptr, true};
  } catch (const CLI::Success& request) {
    program.exit(request);
    return {nullptr, true};
  } catch (const CLI::ParseError& error) {
    throw UsageError(reworded(error, help_of(parsed_command(program))));
  }
  const auto commands = program.get_subcommands();
  if (!commands.empty()) return {commands.front(), false};
  std::cerr << help_for(program, kStandardError);
  return {nullptr, false};
}

CommandDescription describe(const CLI::App& program, const std::string& command) {
  const Program& root = root_of(program);
  if (command.empty()) return described(root, root);
  for (const CLI::App* one : root.get_subcommands({})) {
    if (one->get_name() == command && !is_hidden(*one)) return described(*one, root);
  }
  refuse_command(root, command);
}

std::string name_of(const CLI::App& command) { return command.get_name(); }

CLI::App* add_command(CLI::App& program, const std::string& name, const std::string& help) {
  CLI::App* command = program.add_subcommand(name, help);
  command->get_help_ptr()->group(kGeneralGroup);
  command->add_flag(kEndOfOptions)->group("");
  begin_group(*command, "Options");
  return command;
}

CLI::App* add_hidden_command(CLI::App& program, const std::string& name, const std::string& help) {
  CLI::App* command = add_command(program, name, help);
  command->group("");
  return command;
}

void begin_group(CLI::App& parser, const std::string& heading) {
  parser.option_defaults()->group(heading);
}

void add_flag(CLI::App& parser, const std::string& name, const std::string& help, bool& given) {
  parser.add_flag(name, given, help)->disable_flag_override();
}

void add_flag(CLI::App& parser, const std::string& name, const std::string& help,
              std::function<void()> take) {
  parser.add_flag_callback(name, std::move(take), help)->disable_flag_override();
}

void add_value(CLI::App& parser, const std::string& name, const std::string& type,
               const std::string& help, std::function<void(const std::string&)> take) {
  const std::string shown = name.substr(0, name.find(','));
  const auto take_once = [shown, take = std::move(take)](const CLI::results_t& values) {
    if (values.size() > 1) throw UsageError(shown + " is given twice; give it once");
    // CLI11 takes whatever comes next for the value.
    if (values.front().starts_with("--")) {
      const std::string typed = values.front() == kEndOfOptions ? "--" : values.front();
      throw UsageError(shown + " needs a value and is followed by '" + typed + "'");
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
                    const std::function<void(const std::vector<std::string>&)>& take) {
  parser.add_option_function<std::vector<std::string>>(name, take, help)->type_name(type);
}

void add_argument(CLI::App& parser, const std::string& name, const std::string& help,
                  std::string& value) {
  parser.add_option(name, value, help)->type_name("")->required();
}

void add_optional_argument(CLI::App& parser, const std::string& name, const std::string& help,
                           std::string& value) {
  parser.add_option(name, value, help)->type_name("");
}

void add_optional_arguments(CLI::App& parser, const std::string& name, const std::string& help,
                            std::vector<std::string>& values) {
  parser.add_option(name, values, help)->type_name("");
}

void offer(CLI::App& parser, const std::string& option, Choices choices) {
  root_of(parser).choices[parser.get_option(option)] = std::move(choices);
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

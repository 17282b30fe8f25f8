#include "tools/cli/parser.h"

#include <CLI/CLI.hpp>

#include "tools/cli/errors.h"

namespace softfocus {

CLI::App* add_command(CLI::App& program, const std::string& name, const std::string& help) {
  return program.add_subcommand(name, help);
}

void add_flag(CLI::App& parser, const std::string& name, const std::string& help, bool& given) {
  parser.add_flag(name, given, help);
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

bool is_given(const CLI::App& parser, const std::string& option) {
  return parser.count(option) != 0;
}

}  // namespace softfocus

// A command's description as --help prints it.

#include <algorithm>
#include <string_view>

#include "tools/cli/command_description.h"

namespace softfocus {
namespace {

constexpr std::size_t kNarrowest = 40;
// Names stand left of this column, what they mean right of it; on a narrow terminal below them.
constexpr std::size_t kMeaningColumn = 26, kNarrowMeaningColumn = 6, kNarrow = 60;

/// "  NAME      what it means".
void append_row(std::string& to, const std::string& name, const std::string& meaning,
                std::size_t columns) {
  const std::size_t column = columns < kNarrow ? kNarrowMeaningColumn : kMeaningColumn;
  to += "  " + name;
  std::size_t at = 2 + name.size();
  if (at + 2 > column) {
    to += '\n';
    at = 0;
  }
  to += std::string(column - at, ' ');
  append_wrapped(to, column, meaning, column, columns);
}

}  // namespace

std::size_t text_width(int columns) {
  return std::max(static_cast<std::size_t>(std::max(columns, 0)), kNarrowest);
}

void append_wrapped(std::string& to, std::size_t at, std::string_view text, std::size_t indent,
                    std::size_t columns) {
  bool begins_line = true;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    const std::string_view word = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (!begins_line && at + 1 + word.size() > columns) {
      to += "\n" + std::string(indent, ' ');
      at = indent;
      begins_line = true;
    }
    if (!begins_line) to += ' ';
    to += word;
    at += word.size() + (begins_line ? 0 : 1);
    begins_line = false;
  }
  to += '\n';
}

std::string last_word(const std::string& name) { return name.substr(name.rfind(' ') + 1); }

std::string option_with_value(const OptionDescription& option) {
  std::string text;
  for (const std::string& name : option.names) text += (text.empty() ? "" : ",") + name;
  return text + (option.type.empty() ? "" : " " + option.type);
}

std::string usage_of(const CommandDescription& command) {
  std::string usage = command.name + " [OPTIONS]";
  for (const OptionDescription& argument : command.arguments) {
    const std::string name = argument.names.front() + (argument.is_list ? " ..." : "");
    usage += argument.is_required ? " " + name : " [" + name + "]";
  }
  return usage + (command.commands.empty() ? "" : " COMMAND");
}

std::string help_text(const CommandDescription& command, int columns) {
  const std::size_t width = text_width(columns);
  std::string text;
  append_wrapped(text, 0, command.help, 0, width);
  append_wrapped(text, 0, "Usage: " + usage_of(command), 0, width);
  const auto heading = [&](const std::string& name) { text += "\n" + name + ":\n"; };
  if (!command.arguments.empty()) heading("Arguments");
  for (const OptionDescription& argument : command.arguments) {
    append_row(text, argument.names.front(), argument.help, width);
  }
  if (!command.commands.empty()) heading("Commands");
  for (const CommandDescription& one : command.commands) {
    append_row(text, last_word(one.name), one.help, width);
  }
  for (const OptionGroup& group : command.groups) {
    heading(group.name);
    for (const OptionDescription& option : group.options) {
      append_row(text, option_with_value(option), option.help, width);
    }
  }
  if (!command.commands.empty()) {
    text += '\n';
    append_wrapped(text, 0,
                   command.name + " help COMMAND tells a command's options, " + command.name +
                       " help WORD what a word such as bokeh means. The simulator, a web page with "
                       "sliders: tools/simulator.",
                   0, width);
  }
  return text;
}

}  // namespace softfocus

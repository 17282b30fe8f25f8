// A command's description as a page for man.

#include <cctype>
#include <string_view>

#include "tools/cli/command_description.h"

namespace softfocus {
namespace {

/// Text that troff takes as it is: a minus that can be copied and searched for, no escapes, and no
/// request at a line's beginning.
std::string plain(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    if (safe.empty() && (c == '.' || c == '\'')) safe += "\\&";
    switch (c) {
      case '-': safe += "\\-"; break;
      case '\\': safe += "\\e"; break;
      case '~': safe += "\\(ti"; break;
      case '^': safe += "\\(ha"; break;
      case '`': safe += "\\(ga"; break;
      case '\'': safe += "\\(aq"; break;
      default: safe += c;
    }
  }
  return safe;
}

std::string upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

/// "softfocus-render" of "softfocus render".
std::string page_name(const CommandDescription& command) {
  std::string name = command.name;
  for (char& c : name) c = c == ' ' ? '-' : c;
  return name;
}

void append_option(std::string& to, const OptionDescription& option) {
  to += ".TP\n";
  std::string names;
  for (const std::string& name : option.names) {
    names += (names.empty() ? "\\fB" : ", \\fB") + plain(name) + "\\fR";
  }
  to += names + (option.type.empty() ? "" : " \\fI" + plain(option.type) + "\\fR") + "\n";
  to += plain(option.help) + ".\n";
  // A type that names the values needs no list.
  if (!option.choices || option.type.find('|') != std::string::npos) return;
  std::string list;
  for (const std::string& choice : option.choices()) list += (list.empty() ? "" : ", ") + choice;
  if (!list.empty()) to += "One of: " + plain(list) + ".\n";
}

}  // namespace

std::string man_page(const CommandDescription& command, const std::string& version) {
  const std::string name = page_name(command);
  // No date: a page is the same whenever it is built.
  std::string page = ".TH " + plain(upper(name)) + " 1 \"\" \"softfocus " + plain(version) +
                     "\" \"User Commands\"\n.SH NAME\n" + plain(name) + " \\- " +
                     plain(command.help) + "\n.SH SYNOPSIS\n.B " + plain(usage_of(command)) + "\n";
  if (!command.arguments.empty()) page += ".SH ARGUMENTS\n";
  for (const OptionDescription& argument : command.arguments) append_option(page, argument);
  if (!command.commands.empty()) page += ".SH COMMANDS\n";
  for (const CommandDescription& one : command.commands) {
    page += ".TP\n\\fB" + plain(page_name(one)) + "\\fR(1)\n" + plain(one.help) + ".\n";
  }
  page += ".SH OPTIONS\n";
  for (const OptionGroup& group : command.groups) {
    page += ".SS " + plain(group.name) + "\n";
    for (const OptionDescription& option : group.options) append_option(page, option);
  }
  const std::string last = last_word(command.name);
  const bool compares = last == "compare" || last == "crosscheck";
  page += ".SH EXIT STATUS\n";
  page += compares ? "0: equal, or within the tolerance; 1: different; 2: an error.\n"
                   : "0: done; 1: a file, memory or a driver failed; 2: wrong usage.\n";
  const bool is_program = !command.commands.empty();
  return page + ".SH SEE ALSO\n\\fBsoftfocus" + (is_program ? "\\-help" : "") + "\\fR(1)\n";
}

}  // namespace softfocus

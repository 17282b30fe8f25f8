// A program's description as scripts by which shells complete its command line: commands, options,
// the values that can be named, and files for all else.

#include <algorithm>
#include <string_view>

#include "tools/cli/command_description.h"

namespace softfocus {
namespace {

/// `text` with a backslash before each of `special`.
std::string escaped(std::string_view text, std::string_view special) {
  std::string safe;
  for (const char c : text) {
    if (special.find(c) != special.npos) safe += '\\';
    safe += c;
  }
  return safe;
}

/// Within the single quotes of a POSIX shell.
std::string shell_quoted(std::string_view text) {
  std::string safe = "'";
  for (const char c : text) safe += c == '\'' ? std::string{"'\\''"} : std::string{c};
  return safe + "'";
}

std::string joined(const std::vector<std::string>& words, std::string_view between) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : std::string{between}) + word;
  return text;
}

std::string choices_of(const OptionDescription& option) {
  return option.choices ? joined(option.choices(), " ") : "";
}

/// The arguments' possible values, if they can be named.
std::string argument_choices(const CommandDescription& command) {
  return command.arguments.empty() ? "" : choices_of(command.arguments.front());
}

bool takes_file_too(const OptionDescription& option) {
  return option.type.find("FILE") != option.type.npos;
}

std::string option_names(const CommandDescription& command) {
  std::vector<std::string> names;
  for (const OptionGroup& group : command.groups) {
    for (const OptionDescription& option : group.options) {
      names.insert(names.end(), option.names.begin(), option.names.end());
    }
  }
  return joined(names, " ");
}

std::string bash_case(const CommandDescription& command) {
  const std::string name = last_word(command.name);
  std::string text;
  std::string plain_values;
  for (const OptionGroup& group : command.groups) {
    for (const OptionDescription& option : group.options) {
      if (option.type.empty()) continue;
      const std::string pattern = name + "," + joined(option.names, "|" + name + ",");
      const std::string choices = choices_of(option);
      if (choices.empty()) {
        plain_values += (plain_values.empty() ? "" : "|") + pattern;
      } else {
        text += "    " + pattern + ") words=" + shell_quoted(choices) + " ;;\n";
      }
    }
  }
  if (!plain_values.empty()) text += "    " + plain_values + ") ;;\n";
  const std::string options = shell_quoted(option_names(command));
  if (command.arguments.empty()) return text + "    " + name + ",*) words=" + options + " ;;\n";
  return text + "    " + name + ",*)\n      words=" + shell_quoted(argument_choices(command)) +
         "\n      [[ $current == -* ]] && words=" + options + "\n      ;;\n";
}

std::string zsh_option(const OptionDescription& option) {
  // In a specification brackets end the explanation and colons the message.
  std::string text = shell_quoted("[" + escaped(option.help, "[]:\\") + "]");
  std::vector<std::string> names = option.names;
  if (!option.type.empty()) {
    const std::string choices = choices_of(option);
    text = shell_quoted(
        "[" + escaped(option.help, "[]:\\") + "]:" + escaped(option.type, ":\\") + ":" +
        (choices.empty() || takes_file_too(option) ? "_files" : "(" + choices + ")"));
    for (std::string& name : names) name += name.starts_with("--") ? "=" : "";
  }
  if (names.size() == 1) return names.front() + text;
  return shell_quoted("(" + joined(option.names, " ") + ")") + "{" + joined(names, ",") + "}" +
         text;
}

std::string zsh_case(const CommandDescription& command) {
  std::string text = "        " + last_word(command.name) + ")\n          _arguments -s -S";
  for (const OptionGroup& group : command.groups) {
    for (const OptionDescription& option : group.options) {
      text += " \\\n            " + zsh_option(option);
    }
  }
  const std::string choices = argument_choices(command);
  if (!choices.empty()) {
    text += " \\\n            " +
            shell_quoted("1:" + command.arguments.front().names.front() +
                         ": _alternative \"names:name:(" + choices + ")\" \"files:file:_files\"");
  }
  if (!command.arguments.empty()) text += " \\\n            '*:file:_files'";
  return text + "\n          ;;\n";
}

std::string fish_text(std::string_view text) { return "'" + escaped(text, "'\\") + "'"; }

std::string fish_option(const OptionDescription& option) {
  std::string text;
  for (const std::string& name : option.names) {
    text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  }
  const std::string choices = choices_of(option);
  if (!option.type.empty()) text += choices.empty() || takes_file_too(option) ? " -r" : " -x";
  if (!choices.empty()) text += " -a " + fish_text(choices);
  return text + " -d " + fish_text(option.help) + "\n";
}

std::string fish_lines(const CommandDescription& command) {
  const std::string begin = "complete -c softfocus -n " +
                            fish_text("__fish_seen_subcommand_from " + last_word(command.name));
  std::string text;
  const std::string arguments = argument_choices(command);
  if (command.arguments.empty()) text += begin + " -f\n";
  if (!arguments.empty()) text += begin + " -a " + fish_text(arguments) + "\n";
  for (const OptionGroup& group : command.groups) {
    for (const OptionDescription& option : group.options) text += begin + fish_option(option);
  }
  return text;
}

}  // namespace

std::string bash_completion(const CommandDescription& program) {
  std::vector<std::string> commands;
  std::string cases;
  for (const CommandDescription& command : program.commands) {
    commands.push_back(last_word(command.name));
    cases += bash_case(command);
  }
  return "# Bash's completion for softfocus, made by the program itself.\n"
         "_softfocus() {\n"
         "  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]}\n"
         "  local command='' words='' i\n"
         "  COMPREPLY=()\n"
         "  # Bash splits --method=two-pass into three words.\n"
         "  if [[ $current == = ]]; then\n"
         "    current=''\n"
         "  elif [[ $previous == = ]]; then\n"
         "    previous=${COMP_WORDS[COMP_CWORD - 2]}\n"
         "  fi\n"
         "  for ((i = 1; i < COMP_CWORD; ++i)); do\n"
         "    [[ ${COMP_WORDS[i]} == -- ]] && return\n"
         "    [[ -z $command && ${COMP_WORDS[i]} != -* ]] && command=${COMP_WORDS[i]}\n"
         "  done\n"
         "  # Where nothing can be named, bash offers files.\n"
         "  case $command,$previous in\n"
         "    ,*)\n      words=" +
         shell_quoted(joined(commands, " ")) +
         "\n      [[ $current == -* ]] && words=" + shell_quoted(option_names(program)) +
         "\n      ;;\n" + cases +
         "  esac\n"
         "  COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n"
         "}\n"
         "complete -o default -F _softfocus softfocus\n";
}

std::string zsh_completion(const CommandDescription& program) {
  std::string options, commands, cases;
  for (const OptionGroup& group : program.groups) {
    for (const OptionDescription& option : group.options) {
      options += "    " + zsh_option(option) + " \\\n";
    }
  }
  for (const CommandDescription& command : program.commands) {
    commands +=
        "    " +
        shell_quoted(escaped(last_word(command.name), ":\\") + ":" + escaped(command.help, ":\\")) +
        "\n";
    cases += zsh_case(command);
  }
  return "#compdef softfocus\n"
         "# Zsh's completion for softfocus, made by the program itself.\n"
         "_softfocus() {\n"
         "  local curcontext=\"$curcontext\" state line\n"
         "  local -a commands\n"
         "  commands=(\n" +
         commands +
         "  )\n"
         "  _arguments -C \\\n" +
         options +
         "    '1:command:->command' \\\n"
         "    '*::argument:->argument' && return\n"
         "  case $state in\n"
         "    command) _describe -t commands command commands ;;\n"
         "    argument)\n"
         "      case $words[1] in\n" +
         cases +
         "      esac\n"
         "      ;;\n"
         "  esac\n"
         "}\n"
         "_softfocus \"$@\"\n";
}

std::string fish_completion(const CommandDescription& program) {
  std::string text = "# Fish's completion for softfocus, made by the program itself.\n";
  const std::string first = "complete -c softfocus -n __fish_use_subcommand";
  for (const OptionGroup& group : program.groups) {
    for (const OptionDescription& option : group.options) text += first + fish_option(option);
  }
  for (const CommandDescription& command : program.commands) {
    text += first + " -f -a " + last_word(command.name) + " -d " + fish_text(command.help) + "\n";
    text += fish_lines(command);
  }
  return text;
}

}  // namespace softfocus

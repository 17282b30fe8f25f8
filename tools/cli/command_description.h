#pragma once
// A command's options and arguments as plain data. --help, the man pages and the shells'
// completions are made of it.

#include <functional>
#include <string>
#include <vector>

namespace softfocus {

/// The values that an option can be completed to. Asked for only where they are wanted: scenes
/// are looked for on the disk.
using Choices = std::function<std::vector<std::string>()>;

struct OptionDescription {
  std::vector<std::string> names{};  ///< "-o", "--output"; of an argument "SCENE"
  std::string type{};                ///< stands for the value, "WxH"; empty if it takes none
  std::string help{};
  Choices choices{};  ///< empty if there are too many to name
  bool is_required = false;
  bool is_list = false;  ///< takes all values up to the next option
};

struct OptionGroup {
  std::string name{};
  std::vector<OptionDescription> options{};
};

struct CommandDescription {
  std::string name{};  ///< "softfocus" or "softfocus render"
  std::string help{};
  std::vector<OptionDescription> arguments{};
  std::vector<OptionGroup> groups{};  ///< in the order in which their first options were added
  std::vector<CommandDescription> commands{};
};

/// "render" of "softfocus render".
std::string last_word(const std::string& name);

/// "-o,--output FILE", as --help shows an option.
std::string option_with_value(const OptionDescription& option);

/// "softfocus render [OPTIONS] SCENE".
std::string usage_of(const CommandDescription& command);

/// The text of --help, no line longer than `columns`, if that is 40 or more.
std::string help_text(const CommandDescription& command, int columns);

/// How wide lines are on a terminal of so many columns: 40 at least.
std::size_t text_width(int columns);

/// Appends the words of `text` from column `at` on, in lines that begin at column `indent`.
void append_wrapped(std::string& to, std::size_t at, std::string_view text, std::size_t indent,
                    std::size_t columns);

/// The command's page for man, in the macros of man(7). `version` is the program's.
std::string man_page(const CommandDescription& command, const std::string& version);

/// Scripts by which a shell completes what is typed after the program's name.
std::string bash_completion(const CommandDescription& program);
std::string zsh_completion(const CommandDescription& program);
std::string fish_completion(const CommandDescription& program);

}  // namespace softfocus

// softfocus help: what --help prints. softfocus documentation: the man pages and completions, which
// the build installs.

#include <filesystem>
#include <iostream>
#include <memory>

#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/cli/platform.h"
#include "tools/files/whole_file.h"

namespace softfocus {
namespace {

void write_whole(const std::filesystem::path& file, const std::string& text) {
  std::error_code error;
  std::filesystem::create_directories(file.parent_path(), error);
  WholeFile whole{file};
  whole.write(text);
  whole.commit();
}

/// Files at the places where systems look for them, below a `share` folder.
void write_documentation(const CommandDescription& program, const std::filesystem::path& share) {
  const auto write_page = [&](const CommandDescription& command, const std::string& name) {
    write_whole(share / "man" / "man1" / (name + ".1"), man_page(command, SOFTFOCUS_VERSION));
  };
  write_page(program, program.name);
  for (const CommandDescription& command : program.commands) {
    write_page(command, program.name + "-" + last_word(command.name));
  }
  write_whole(share / "bash-completion" / "completions" / program.name, bash_completion(program));
  // Debian's zsh looks into the second of these alone.
  const std::string zsh = zsh_completion(program);
  write_whole(share / "zsh" / "site-functions" / ("_" + program.name), zsh);
  write_whole(share / "zsh" / "vendor-completions" / ("_" + program.name), zsh);
  write_whole(share / "fish" / "vendor_completions.d" / (program.name + ".fish"),
              fish_completion(program));
}

}  // namespace

Command add_help_command(CLI::App& program) {
  CLI::App* parser = add_command(program, "help", "Print the help of a command");
  const auto command = std::make_shared<std::string>();
  add_optional_argument(*parser, "COMMAND", "A command (default: all of them)", *command);
  offer(*parser, "COMMAND", [&program] {
    std::vector<std::string> names;
    for (const CommandDescription& one : describe(program, "").commands) {
      names.push_back(last_word(one.name));
    }
    return names;
  });
  return {parser, [&program, command] {
            std::cout << help_text(describe(program, *command), columns_of(kStandardOutput));
            return kDone;
          }};
}

Command add_documentation_command(CLI::App& program) {
  CLI::App* parser = add_hidden_command(program, "documentation",
                                        "Write the man pages and the shells' completions");
  const auto share = std::make_shared<std::string>();
  add_argument(*parser, "DIR", "A share folder, made if missing", *share);
  return {parser, [&program, share] {
            write_documentation(describe(program, ""), *share);
            return kDone;
          }};
}

}  // namespace softfocus

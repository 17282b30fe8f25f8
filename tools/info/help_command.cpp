// softfocus help: what --help prints, and the field's words. softfocus documentation: the man pages
// and completions, which the build installs.

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include "dof/dof.h"
#include "raster/effects/effect.h"
#include "scenes/lens_views/lens_view_method.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/cli/platform.h"
#include "tools/files/whole_file.h"
#include "tools/info/words.h"

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

/// What a word means that names no command; nothing if it is not known.
std::string meaning_of(const std::string& name, int columns) {
  std::string text;
  const auto add = [&](std::string_view meaning, const std::string& places) {
    text += text_of({name, meaning, places}, columns);
  };
  const std::string as_method = "softfocus render --method " + name + ", docs/methods.md";
  if (const Method* method = find_method(name)) add(method->summary, as_method);
  if (const LensViewMethod* method = find_lens_view_method(name)) add(method->summary, as_method);
  if (const Effect* effect = find_effect(name)) {
    add(effect->summary, "softfocus apply --effect " + name + ", docs/effects/README.md");
  }
  for (const Word& word : find_words(name)) text += text_of(word, columns);
  return text;
}

}  // namespace

Command add_help_command(CLI::App& program) {
  CLI::App* parser =
      add_command(program, "help", "Print the help of a command, or what a word means");
  const auto words = std::make_shared<std::string>();
  add_value_list(
      *parser, "COMMAND", "",
      "A command, or a word such as bokeh or circle of confusion (default: all commands)",
      [words](const std::vector<std::string>& given) {
        for (const std::string& one : given) *words += (words->empty() ? "" : " ") + one;
      });
  offer(*parser, "COMMAND", [&program] {
    std::vector<std::string> names;
    for (const CommandDescription& one : describe(program, "").commands) {
      names.push_back(last_word(one.name));
    }
    return names;
  });
  return {
      parser, [&program, words] {
        const int columns = columns_of(kStandardOutput);
        const std::vector<CommandDescription> commands = describe(program, "").commands;
        const bool is_command =
            words->empty() || std::any_of(commands.begin(), commands.end(), [&](const auto& one) {
              return last_word(one.name) == *words;
            });
        const std::string meaning = is_command ? "" : meaning_of(*words, columns);
        std::cout << (meaning.empty() ? help_text(describe(program, *words), columns) : meaning);
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

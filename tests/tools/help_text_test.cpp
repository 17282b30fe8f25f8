#include <doctest/doctest.h>

#include <algorithm>
#include <sstream>

#include "tools/cli/command_description.h"

using namespace softfocus;

namespace {

CommandDescription of_one_option(const std::string& help) {
  return {.name = "softfocus draw",
          .help = "Draw",
          .arguments = {{.names = {"SCENE"}, .help = "What", .is_required = true},
                        {.names = {"MORE"}, .help = "What else", .is_list = true}},
          .groups = {{"Lens", {{.names = {"-o", "--open"}, .type = "N", .help = help}}}}};
}

std::size_t longest_line(const std::string& text) {
  std::istringstream lines{text};
  std::size_t longest = 0;
  for (std::string line; std::getline(lines, line);) longest = std::max(longest, line.size());
  return longest;
}

}  // namespace

TEST_CASE("help: usage, arguments and options by their groups, meanings in a column") {
  CHECK(help_text(of_one_option("How far"), 80) ==
        "Draw\n"
        "Usage: softfocus draw [OPTIONS] SCENE [MORE ...]\n"
        "\n"
        "Arguments:\n"
        "  SCENE                   What\n"
        "  MORE                    What else\n"
        "\n"
        "Lens:\n"
        "  -o,--open N             How far\n");
}

TEST_CASE("help: lines are as long as they may be, and no longer") {
  std::string words;
  for (int i = 0; i < 60; ++i) words += "twelve bytes ";
  for (const int columns : {40, 59, 60, 80, 99}) {
    CAPTURE(columns);
    const std::size_t longest = longest_line(help_text(of_one_option(words), columns));
    CHECK(longest <= static_cast<std::size_t>(columns));
    CHECK(longest + 7 > static_cast<std::size_t>(columns));
  }
  // Narrower than a line can well be; a word that fits nowhere stays whole.
  CHECK(longest_line(help_text(of_one_option("a b c"), -1)) <= 48);
  CHECK(help_text(of_one_option(std::string(200, 'x')), 80).find(std::string(200, 'x')) !=
        std::string::npos);
}

TEST_CASE("man: what troff would take for its own is taken as text") {
  const std::string page = man_page(of_one_option(".dot, 'quote', back\\slash, a-b"), "1.2");
  CHECK(page.find("\n\\&.dot, \\(aqquote\\(aq, back\\eslash, a\\-b.\n") != std::string::npos);
  CHECK(page.starts_with(".TH SOFTFOCUS\\-DRAW 1 \"\" \"softfocus 1.2\" \"User Commands\"\n"));
}

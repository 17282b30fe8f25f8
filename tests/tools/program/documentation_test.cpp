// Man pages and completions, as the build installs them.

#include "tests/support/cli_render.h"
#include "tests/support/skip.h"

using namespace softfocus;

namespace {

/// A share folder with everything in it.
class Share {
 public:
  Share() {
    const ProgramRun run = run_program({"documentation", directory_.path()});
    REQUIRE(run.status == 0);
    REQUIRE(run.out + run.err == "");
  }
  std::string file(const std::string& name) const { return directory_.file(name); }
  std::string page(const std::string& name) const {
    return read_file(directory_.file("man/man1/" + name + ".1"));
  }

 private:
  TemporaryDirectory directory_;
};

/// A command line's output, errors too, and its status in `status`.
std::string said_by(const std::string& command, int& status) {
  std::FILE* const pipe = ::popen((command + " 2>&1").c_str(), "r");
  REQUIRE(pipe != nullptr);
  std::string text;
  for (int c; (c = std::fgetc(pipe)) != EOF;) text += static_cast<char>(c);
  status = ::pclose(pipe);
  return text;
}

bool is_there(const std::string& program) {
  int status = 0;
  said_by("command -v " + program, status);
  return status == 0;
}

/// The words that begin a row of a help: "-o", "--output" of "  -o,--output FILE".
Words first_words(const std::string& help, char first) {
  Words words;
  for (std::size_t at = 0; (at = help.find("\n  ", at)) != std::string::npos; ++at) {
    if (help[at + 3] == ' ' || (help[at + 3] == '-') != (first == '-')) continue;
    const std::string row = help.substr(at + 3, help.find_first_of(" \n", at + 3) - at - 3);
    const std::size_t comma = row.find(',');
    words.push_back(row.substr(0, comma));
    if (comma != row.npos) words.push_back(row.substr(comma + 1));
  }
  return words;
}

Words commands() {
  const std::string help = run_program({"--help"}).out;
  return first_words(help.substr(0, help.find("\nGeneral:")), 'a');
}

/// Bash's offers for the last word.
Words completed(const Share& share, const Words& words) {
  std::string line;
  for (const std::string& word : words) line += " '" + word + "'";
  int status = 0;
  const std::string said =
      said_by("bash -c 'source \"" + share.file("bash-completion/completions/softfocus") +
                  "\"; COMP_WORDS=(\"$@\"); COMP_CWORD=$(($# - 1)); _softfocus; "
                  "printf \"%s\\n\" \"${COMPREPLY[@]}\"' bash softfocus" +
                  line,
              status);
  CHECK(status == 0);
  Words found;
  for (std::size_t start = 0; start < said.size();) {
    const std::size_t end = said.find('\n', start);
    if (end > start) found.push_back(said.substr(start, end - start));
    start = end + 1;
  }
  return found;
}

bool has(const Words& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

}  // namespace

TEST_CASE("documentation: every command has a man page, with every option of its help") {
  const Share share;
  const std::string whole = share.page("softfocus");
  const Words all = commands();
  CHECK(all.size() >= 17);
  for (const std::string& command : all) {
    CAPTURE(command);
    CHECK(contains(whole, "softfocus\\-" + command));
    const std::string page = share.page("softfocus-" + command);
    const Words options = first_words(run_program({command, "--help"}).out, '-');
    CHECK(has(options, "--help"));
    for (std::string option : options) {
      CAPTURE(option);
      for (std::size_t at = 0; (at = option.find('-', at)) != option.npos; at += 2) {
        option.insert(at, "\\");
      }
      CHECK(contains(page, "\\fB" + option + "\\fR"));
    }
  }
  CHECK(contains(share.page("softfocus-render"), "two\\-pass"));
}

TEST_CASE("documentation: man pages have no fault that troff knows") {
  if (!is_there("groff")) return skip("groff", "no groff");
  const Share share;
  int status = 0;
  CHECK(said_by("groff -man -Tutf8 -ww -z '" + share.file("man/man1") + "'/*.1", status) == "");
  CHECK(status == 0);
}

TEST_CASE(
    "documentation: bash completes commands, options and values, and leaves files to itself") {
  if (!is_there("bash")) return skip("bash", "no bash");
  const Share share;
  CHECK(completed(share, {"ren"}) == Words{"render"});
  CHECK(has(completed(share, {""}), "refocus"));
  CHECK(has(completed(share, {"-"}), "--version"));
  CHECK(completed(share, {"render", "--f-n"}) == Words{"--f-number"});
  CHECK(completed(share, {"render", "--method", "accum"}) == Words{"accumulation"});
  CHECK(completed(share, {"render", "--method", "=", "accum"}) == Words{"accumulation"});
  CHECK(has(completed(share, {"render", "--method", "="}), "two-pass"));
  CHECK(has(completed(share, {"render", "--profile", ""}), "llvmpipe"));
  CHECK(completed(share, {"render", "--show", ""}) ==
        Words{"image", "pinhole", "coc", "depth", "wireframe"});
  CHECK(completed(share, {"render", "figu"}) == Words{"figures"});
  CHECK(completed(share, {"render", "figures", "-o", ""}).empty());
  CHECK(completed(share, {"render", "figures", "--", "--f-n"}).empty());
  CHECK(completed(share, {"refocus", "-o", "a", "--sens"}) == Words{"--sensor"});
  CHECK(completed(share, {"refocus", ""}).empty());
  CHECK(completed(share, {"help", "refo"}) == Words{"refocus"});
  CHECK(completed(share, {"nonsense", "--me"}).empty());
  for (const std::string& command : commands()) {
    CHECK(has(completed(share, {command, "--he"}), "--help"));
  }
}

TEST_CASE("documentation: completions are programs that their shells can read") {
  const Share share;
  const auto check_syntax = [&](const std::string& shell, const std::string& script) {
    if (!is_there(shell)) return skip(shell, "no " + shell);
    int status = 0;
    CHECK(said_by(shell + " -n '" + share.file(script) + "'", status) == "");
    CHECK(status == 0);
  };
  check_syntax("bash", "bash-completion/completions/softfocus");
  check_syntax("zsh", "zsh/site-functions/_softfocus");
  check_syntax("zsh", "zsh/vendor-completions/_softfocus");
  check_syntax("fish", "fish/vendor_completions.d/softfocus.fish");
}

TEST_CASE("docs/command-line.md: its ranges and defaults are those of the help") {
  const std::string document = read_file(SOFTFOCUS_TEST_DATA "/../../docs/command-line.md");
  std::string help;  // a blank between two words
  for (const char c : run_program({"render", "--help"}).out) {
    if (c == '\n' || c == ' ') {
      if (!help.ends_with(' ')) help += ' ';
    } else {
      help += c;
    }
  }
  int rows = 0;
  for (std::size_t at = 0; (at = document.find("\n| `--", at)) != document.npos; ++at) {
    std::vector<std::string> cells;
    std::size_t bar = at + 1;
    for (std::size_t next; cells.size() < 3; bar = next) {
      next = document.find(" |", bar + 1) + 1;
      cells.push_back(document.substr(bar + 2, std::max(next, bar + 3) - bar - 3));
    }
    if (std::count(cells[0].begin(), cells[0].end(), '`') != 2 || !contains(cells[1], " to ")) {
      continue;  // of another table
    }
    CAPTURE(cells[0]);
    const std::string option = " " + cells[0].substr(1, cells[0].size() - 2) + " ";
    const std::size_t begin = help.find(option);
    REQUIRE(begin != help.npos);
    const std::string meaning = help.substr(begin, help.find(" --", begin + 4) - begin);
    CHECK(contains(meaning,
                   "(" + cells[1] + (cells[2].empty() ? "" : "; default: " + cells[2]) + ")"));
    ++rows;
  }
  CHECK(rows == 20);
  // And none is missing.
  int in_help = 0;
  for (std::size_t at = 0; (at = help.find(" to ", at + 1)) != help.npos;) {
    const std::size_t open = help.rfind('(', at), close = help.find(')', at);
    const std::string inside = help.substr(open + 1, close - open - 1);
    const bool is_range = inside.find_first_of("-0123456789") == 0 || inside.starts_with("above 0");
    if (is_range && close < help.find('(', at)) ++in_help;
  }
  CHECK(in_help == rows);
}

// Habits of other programs that a user expects here too.

#include "tests/support/cli_refused.h"
#include "tests/support/cli_render.h"

using namespace softfocus;

namespace {

/// The program as the left side of a pipe whose right side has ended before.
void check_quiet_when_nobody_reads(const std::string& arguments) {
  CAPTURE(arguments);
  const TemporaryDirectory directory;
  const std::string status = directory.file("status"), said = directory.file("said");
  const std::string command = "(sleep 0.2; '" + std::string{SOFTFOCUS_PROGRAM} + "' " + arguments +
                              " 2>'" + said + "'; echo $? >'" + status + "') | true";
  CHECK(std::system(command.c_str()) == 0);
  CHECK(read_file(status) == "0\n");
  CHECK(read_file(said) == "");
}

std::size_t longest_line(const std::string& text) {
  std::size_t longest = 0;
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    longest = std::max(longest, end - start);
    start = end + 1;
  }
  return longest;
}

}  // namespace

TEST_CASE("habits: -V tells the version as --version does") {
  const ProgramRun run = run_program({"-V"});
  CHECK(run.status == 0);
  CHECK(run.out.starts_with("softfocus 0."));
  CHECK(run.out == run_program({"--version"}).out);
}

TEST_CASE("habits: help COMMAND prints what COMMAND --help does, help alone the commands") {
  for (const char* command : {"render", "refocus", "help"}) {
    const ProgramRun run = run_program({"help", command});
    CHECK(run.status == 0);
    CHECK(run.err == "");
    CHECK(run.out == run_program({command, "--help"}).out);
    CHECK(contains(run.out, "Usage: softfocus " + std::string{command} + " [OPTIONS]"));
  }
  CHECK(run_program({"help"}).out == run_program({"--help"}).out);
  const TemporaryDirectory directory;
  check_refused(directory, {"help", "rendr"}, 2, {"'rendr'", "did you mean 'render'?"});
  check_refused(directory, {"help", "documentation"}, 2, {"'documentation'"});
  check_refused(directory, {"help", "render", "refocus"}, 2, {"'render refocus'"});
}

TEST_CASE("habits: a mistyped name is answered with the one that was meant") {
  const TemporaryDirectory directory;
  const std::string out = directory.file("out.png");
  const auto means = [&](const Words& words, const std::string& name, int status = 2) {
    check_refused(directory, words, status, {"did you mean '" + name + "'?"});
  };
  means({"rendr"}, "render");
  means({"render", "figures", "-o", out, "--fnumber", "2"}, "--f-number");
  means({"render", "figures", "-o", out, "--fnumber=2"}, "--f-number");
  means({"render", "figures", "-o", out, "--aperture", "7"}, "--aperture-blades");
  means({"render", "figures", "-o", out, "--method", "two-pas"}, "two-pass");
  means({"render", "figures", "-o", out, "--method", "acumulation"}, "accumulation");
  means({"render", "figures", "-o", out, "--profile", "llvmpip"}, "llvmpipe");
  means({"render", "figures", "-o", out, "--show", "imgae"}, "image");
  means({"render", "figures", "-o", out, "--arithmetic", "fixd"}, "fixed");
  means({"render", "figurse", "-o", out}, "figures", 1);
  means({"refocus", "a.exr", "-o", out, "--depth-encoding", "meters"}, "metres");
  means({"refocus", "a.exr", "-o", out, "--sensor", "fullframe"}, "full-frame");
  means({"refocus", "a.exr", "-o", out, "--upsample", "color"}, "colour");
  means({"refocus", "a.exr", "-o", out, "--border", "miror"}, "mirror");
  means({"chart", "-o", directory.file("c"), "--methods", "disk-layers"}, "disc-layers");
  means({"stress", "-o", directory.file("s"), "--cases", "near-egde"}, "near-edge");
}

TEST_CASE("habits: an unknown option's error tells how to see those there are") {
  const TemporaryDirectory directory;
  check_refused(directory, {"lens", "--nothing"}, 2,
                {"unknown option '--nothing'; softfocus lens --help lists"});
  check_refused(directory, {"--nothing"}, 2,
                {"unknown option '--nothing'; softfocus --help lists"});
}

TEST_CASE("habits: after -- nothing is an option") {
  const TemporaryDirectory directory;
  const std::string bytes = rendered("figures", {}, "a.png");
  write_file(directory.file("x"), bytes);
  write_file(directory.file("-x.png"), bytes);
  const auto in_directory = [&](const std::string& arguments) {
    return std::system(("cd '" + directory.path() + "' && '" + SOFTFOCUS_PROGRAM + "' " +
                        arguments + " >/dev/null 2>&1")
                           .c_str());
  };
  CHECK(in_directory("compare -- -x.png -x.png") == 0);
  CHECK(in_directory("compare x -- -x.png") == 0);
  CHECK(in_directory("compare --flicker x x --against x x -- ") == 0);
  CHECK(in_directory("inspect -- -x.png x -x.png") == 0);
  CHECK(in_directory("inspect x -- -x.png") == 0);
  CHECK(in_directory("compare -x.png -x.png") != 0);
  check_refused(directory, {"scenes", "--", "--json"}, 2, {"unexpected argument './--json'"});
  check_refused(directory, {"render", "figures", "-o", "--", "a.png"}, 2,
                {"-o needs a value and is followed by '--'"});
  check_refused(directory, {"render", "--", "--autofocus", "-o"}, 2, {});
}

TEST_CASE("habits: help fits the columns there are, and 80 if nobody says") {
  const auto longest_of = [](const char* columns) {
    columns != nullptr ? ::setenv("COLUMNS", columns, 1) : ::unsetenv("COLUMNS");
    const std::size_t longest = longest_line(run_program({"render", "--help"}).out);
    ::unsetenv("COLUMNS");
    return longest;
  };
  CHECK(longest_of(nullptr) <= 80);
  CHECK(longest_of(nullptr) > 70);
  CHECK(longest_of("50") <= 50);
  CHECK(longest_of("nonsense") == longest_of(nullptr));
  CHECK(longest_of("0") == longest_of(nullptr));
  CHECK(longest_of("-5") == longest_of(nullptr));
  CHECK(longest_of("99999999999999999999") <= 100);
  for (const char* command : {"refocus", "compare", "bench", "stress", "chart", "help"}) {
    CHECK(longest_line(run_program({command, "--help"}).out) <= 80);
  }
}

TEST_CASE("habits: help lists options in groups") {
  const std::string help = run_program({"render", "--help"}).out;
  std::size_t before = 0;
  for (const char* group : {"Arguments", "Scene", "Output", "Lens", "Method", "Run", "General"}) {
    CAPTURE(group);
    const std::size_t at = help.find("\n" + std::string{group} + ":\n");
    REQUIRE(at != std::string::npos);
    CHECK(at > before);
    before = at;
  }
  CHECK(help.find("--f-number") > help.find("\nLens:"));
  CHECK(help.find("--f-number") < help.find("\nMethod:"));
  CHECK(help.find("--help") > help.find("\nGeneral:"));
  CHECK(!contains(help, "--end-of-options"));
  CHECK(!contains(run_program({"--help"}).out, "documentation"));
}

TEST_CASE("habits: a size may have a capital X") {
  CHECK(rendered("figures", {}) != "");
  const TemporaryDirectory directory;
  const std::string out = directory.file("a.npy");
  CHECK(run_program({"render", "figures", "-o", out, "--size", "64X32"}).status == 0);
  CHECK(contains(read_file(out).substr(0, 128), "(32, 64, 4)"));
}

TEST_CASE("habits: every list can be had as JSON") {
  const auto names = [](const char* command) {
    const ProgramRun run = run_program({command, "--json"});
    CHECK(run.status == 0);
    Words found;
    for (const auto& entry : nlohmann::json::parse(run.out)) {
      found.push_back(entry.at("name").get<std::string>());
    }
    return found;
  };
  const auto has = [](const Words& all, const char* name) {
    return std::find(all.begin(), all.end(), name) != all.end();
  };
  CHECK(has(names("scenes"), "figures"));
  CHECK(has(names("methods"), "two-pass"));
  CHECK(has(names("methods"), "auto"));
  CHECK(has(names("profiles"), "llvmpipe"));
  CHECK(!names("shaders").empty());
  CHECK(nlohmann::json::parse(run_program({"lens", "--json"}).out).is_object());
}

TEST_CASE("habits: who reads no more is no failure") {
  check_quiet_when_nobody_reads("methods");
  check_quiet_when_nobody_reads("scenes --json");
  check_quiet_when_nobody_reads("render --help");
  check_quiet_when_nobody_reads("render figures --size 256x256 --max-coc 16 -o - --format npy");
}

TEST_CASE("habits: -q is silent but for warnings, and not together with -v") {
  const TemporaryDirectory directory;
  const ProgramRun run = run_program(render("figures", directory.file("a.png"), {"-q"}));
  CHECK(run.status == 0);
  CHECK(run.out == "");
  CHECK(run.err == "");
  const std::string circles = directory.file("circles.png");
  const std::string picture = directory.file("a.npy");
  REQUIRE(run_program(render("figures", picture)).status == 0);
  CHECK(run_program({"inspect", picture, "-o", circles}).err != "");
  CHECK(run_program({"inspect", picture, "-o", circles, "--quiet"}).err == "");
  const ProgramRun warned = run_program(render(
      "figures", picture, {"-q", "--method", "accumulation", "--samples", "2", "--until", "1e-9"}));
  CHECK(is_one_line(warned.err));
  CHECK(contains(warned.err, "warning: --until 1e-09: not reached with 2 samples"));
  check_refused(directory, render("figures", picture, {"-q", "-v"}), 2, {"-v and -q"});
  check_refused(directory, {"refocus", picture, "-o", "b.png", "-v", "--quiet"}, 2, {"-v and -q"});
}

// The recipes of docs/exactness.md for other people's shaders and engines, from end to end.

#include <doctest/doctest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "tests/support/cli_refused.h"
#include "tests/support/gl_drivers.h"
#include "tools/gl/driver/driver.h"
#include "tools/gl/shaders.h"

using namespace softfocus;

namespace {

using Words = std::vector<std::string>;

// Much of this picture is out of focus.
Words frame(const std::string& output, const Words& more) {
  Words words{"render", "figures", "--size", "64x48", "--max-coc", "6", "--coc-scale", "4"};
  words.insert(words.end(), {"-o", output});
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

void render_frame(const std::string& output, const Words& more) {
  const ProgramRun run = run_program(frame(output, more));
  CHECK(run.status == 0);
  CHECK(run.err == "");
}

nlohmann::json compared(const std::string& a, const std::string& b) {
  return nlohmann::json::parse(run_program({"compare", a, b, "--json"}).out);
}

std::string profile_of(const std::string& driver) {
  return std::string{find_driver(driver)->profile};
}

// The project's shaders, one of them altered.
void write_shaders(const TemporaryDirectory& directory, const std::string& shader,
                   const std::string& from, const std::string& to) {
  REQUIRE(run_program({"shaders", "-o", directory.path()}).status == 0);
  std::string text = read_file(directory.file(shader));
  const std::size_t at = text.find(from);
  REQUIRE(at != text.npos);
  text.replace(at, from.size(), to);
  write_file(directory.file(shader), text);
}

// A Python that has NumPy, or nothing. Debian's first: another may stand before it without.
std::string python() {
  for (const char* name : {"/usr/bin/python3", "python3"}) {
    if (std::system((std::string{name} + " -c 'import numpy' 2>/dev/null").c_str()) == 0)
      return name;
  }
  return {};
}

}  // namespace

TEST_CASE("render: --gl with the project's shaders in a folder gives the profile's bits") {
  if (!has_driver("llvmpipe")) return;
  const TemporaryDirectory shaders, pictures;
  REQUIRE(run_program({"shaders", "-o", shaders.path()}).status == 0);
  const std::string theirs = pictures.file("theirs.npy"), ours = pictures.file("ours.npy");
  render_frame(theirs, {"--gl", "llvmpipe", "--shaders", shaders.path()});
  render_frame(ours, {"--profile", profile_of("llvmpipe")});
  const auto result = compared(theirs, ours);
  CHECK(result["differing"] == 0);
  CHECK(result["values"] == 64 * 48 * 4);
  const auto notes = nlohmann::json::parse(read_file(theirs + ".json"));
  CHECK(notes["method"]["shaders"] == shaders.path());
}

TEST_CASE("render: --gl keeps what a user's own shader computes") {
  if (!has_driver("llvmpipe")) return;
  const TemporaryDirectory shaders, pictures;
  write_shaders(shaders, "weights.glsl", "weight = (overlap(", "weight = 0.5 * (overlap(");
  const std::string theirs = pictures.file("theirs.npy"), ours = pictures.file("ours.npy");
  render_frame(theirs, {"--gl", "llvmpipe", "--shaders", shaders.path()});
  render_frame(ours, {"--gl", "llvmpipe"});
  CHECK(compared(theirs, ours)["differing"] > 1000);
}

TEST_CASE("render: a shader that the driver refuses is told with its file and line") {
  if (!has_driver("llvmpipe")) return;
  const TemporaryDirectory shaders, pictures;
  write_shaders(shaders, "weights.glsl", "float leakage(", "flot leakage(");
  check_refused(pictures,
                frame(pictures.file("a.npy"), {"--gl", "llvmpipe", "--shaders", shaders.path()}), 1,
                {"driver llvmpipe: " + shaders.file("weights.glsl") + ":46(", "error"});
}

TEST_CASE("render: --shaders that can have no part in the picture are refused") {
  const TemporaryDirectory shaders, pictures;
  const std::string output = pictures.file("a.npy");
  write_shaders(shaders, "two_pass_tiled.frag", "void main()", "// mine\nvoid main()");
  const auto refused = [&](const Words& more, const Words& named) {
    check_refused(pictures, frame(output, more), 2, named);
  };
  refused({"--shaders", shaders.path()}, {"--shaders: ", "give --gl DRIVER"});
  refused({"--gl", "llvmpipe", "--shaders", shaders.path()},
          {"has no part in this picture", "two_pass.frag"});
  refused({"--gl", "llvmpipe", "--method", "disc-layers"}, {"has no shader", "two-pass"});
  refused({"--gl", "llvmpipe", "--shaders", pictures.path()}, {"has none of the shaders"});
  refused({"--gl", "llvmpipe", "--shaders", "/nonexistent"}, {"there is no such folder"});
}

TEST_CASE("render: no picture is written over a shader that it is made by") {
  const TemporaryDirectory shaders;
  write_shaders(shaders, "two_pass.frag", "void main()", "// mine\nvoid main()");
  const std::string shader = shaders.file("two_pass.frag");
  const std::string before = read_file(shader);
  check_refused(shaders,
                frame(shader, {"--format", "png", "--gl", "llvmpipe", "--shaders", shaders.path()}),
                2, {"would write over a shader"});
  CHECK(read_file(shader) == before);
}

TEST_CASE("a compiler's first error is found behind warnings, and its number becomes a file") {
  const Words files{"a.frag", "b.glsl"};
  CHECK(first_error("1:12(3): error: no\n", files) == "b.glsl:12(3): error: no");
  CHECK(first_error("0:1(1): warning: hm\n0:2(1): error: no", files) == "a.frag:2(1): error: no");
  CHECK(first_error("0(7) : error C1: no", files) == "a.frag(7) : error C1: no");
  CHECK(first_error("ERROR: 1:7: no", files) == "b.glsl:7: no");
  CHECK(first_error("9:1: error", files) == "a.frag: 9:1: error");
  CHECK(first_error("no idea", files) == "a.frag: no idea");
  CHECK(first_error("", files) == "a.frag: ");
}

TEST_CASE("an engine with hyperbolic depth gives llvmpipe's bits if it rounds metres to halves") {
  const std::string program = python();
  if (program.empty()) return skip("numpy", "no python3 with NumPy");
  const TemporaryDirectory folder;
  const std::string in = folder.file("in.npy"), golden = folder.file("golden.npy"),
                    now = folder.file("now.npy"), report = folder.file("golden.json"),
                    given = folder.file("given");
  render_frame(in, {"--profile", "llvmpipe", "--show", "pinhole"});
  const ProgramRun run = run_program(frame(golden, {"--profile", "llvmpipe", "--json"}));
  REQUIRE(run.status == 0);
  write_file(report, run.out);
  const auto differing = [&](const std::string& depth, const std::string& halves) {
    const std::string script =
        program + " " SOFTFOCUS_TEST_DATA "/../../docs/examples/hyperbolic_depth.py ";
    const std::string give = script + "give " + in + ' ' + report + ' ' + depth + ' ' + given;
    const std::string play =
        script + "play " + given + ' ' + report + ' ' + depth + ' ' + now + ' ' + halves;
    REQUIRE(std::system(give.c_str()) == 0);
    REQUIRE(std::system(play.c_str()) == 0);
    const auto result = compared(now, golden);
    CHECK(result["values"] == 64 * 48 * 3);  // the engine's picture has no alpha
    return result["differing"].get<int>();
  };
  CHECK(differing("metres", "") == 0);
  for (const std::string depth : {"d24", "float", "float-reversed"}) {
    CAPTURE(depth);
    CHECK(differing(depth, "") > 0);
    CHECK(differing(depth, "nearest") == 0);
  }
  CHECK(differing("d24", "truncated") > differing("d24", ""));
}

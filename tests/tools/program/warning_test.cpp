#include <doctest/doctest.h>

#include <algorithm>

#include "tests/support/cli_render.h"

using namespace softfocus;

namespace {

// Triangles in five materials that nobody defines.
std::string model_without_materials() {
  std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (const char* name : {"a", "b", "c", "d", "e"}) {
    text += std::string("v 0 0 ") + std::to_string(name[0]) + "\nusemtl " + name + "\nf 1 2 -1\n";
  }
  return text;
}

std::ptrdiff_t lines_of(const std::string& text) {
  return std::count(text.begin(), text.end(), '\n');
}

}  // namespace

TEST_CASE(
    "render: what a model lacks is warned of, in three lines and a count, and is no failure") {
  const TemporaryDirectory directory;
  write_file(directory.file("m.obj"), model_without_materials());
  const ProgramRun run =
      run_program(render(directory.file("m.obj"), directory.file("a.npy"), {"--max-coc", "4"}));
  CHECK(run.status == 0);
  CHECK(run.err.starts_with("softfocus: warning: "));
  CHECK(run.err.find("material a is not defined") != std::string::npos);
  CHECK(run.err.find("2 more; -v lists them") != std::string::npos);
  CHECK(run.err.find("m: a lens of 50 mm at f/2") != std::string::npos);
  CHECK(lines_of(run.err) == 5);
}

TEST_CASE("render: with -v every warning is a line") {
  const TemporaryDirectory directory;
  write_file(directory.file("m.obj"), model_without_materials());
  const ProgramRun run =
      run_program(render(directory.file("m.obj"), directory.file("a.npy"), {"-v"}));
  CHECK(run.err.find("material e is not defined") != std::string::npos);
  CHECK(run.err.find("more; -v") == std::string::npos);
}

// What tools/portability runs of `crosscheck`.

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <span>
#include <string>

#include "raster/shaders/glsl/glsl.h"
#include "raster/shaders/spirv_module.h"
#include "scenes/files/file_bytes.h"
#include "tests/support/run_program.h"
#include "tests/support/skip.h"
#include "tools/crosscheck/cases.h"

using namespace softfocus;

TEST_CASE("the fewer quick cases run each shader that has a C++ form, and keep its SPIR-V") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const TemporaryDirectory directory;
  const Profile profile;
  const Shaders shaders;
  ThreadPool pool{2};
  const GlContext gl{*find_driver("emulated"), 2, profile, directory.path()};
  const std::vector<Case> cases = quick_cases(true);
  CHECK(cases.size() < quick_cases(false).size() / 4);
  for (const Case& one : cases) {
    CAPTURE(one.stage + '/' + one.name);
    Tally tally;
    one.run({gl, shaders, profile, pool}, tally);
    CHECK(tally.values > 0);
    CHECK(tally.differing == 0);
  }
  for (const Shader& shader : built_in_shaders()) {
    CAPTURE(shader.name);
    if (!shader.name.ends_with(".frag") && !shader.name.ends_with(".vert")) continue;
    // The probe's own, and two of the lesson.
    if (shader.name == "arithmetic.frag" || shader.name == "gather.frag" ||
        shader.name == "weights.frag") {
      continue;
    }
    const std::string text = shader_source(shaders, shader.name).text;
    CHECK(std::any_of(gl.programs().begin(), gl.programs().end(), [&](const auto& program) {
      return program.first.find(text) != std::string::npos;
    }));
  }
  std::size_t kept = 0;
  for (const auto& file : std::filesystem::directory_iterator{directory.path()}) {
    const std::string bytes = read_file_bytes(file.path(), std::size_t{1} << 20);
    CHECK(read_spirv(spirv_words(std::as_bytes(std::span{bytes}))).main != 0);
    ++kept;
  }
  CHECK(kept > gl.programs().size());
}

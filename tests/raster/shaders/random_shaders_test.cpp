#include <doctest/doctest.h>

#include "tests/support/random_spirv.h"
#include "tests/support/shader_checks.h"

using namespace softfocus;

TEST_CASE("random shaders have a pixel's bits on every unit, at every width, simplified or not") {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    CAPTURE(seed);
    const test::CheckResult result = test::check_shader(test::RandomSpirv{seed}.words(), seed);
    CHECK(!result.is_stopped);
    CHECK(result.difference == "");
  }
}

TEST_CASE("damaged SPIR-V is refused in words, or runs and ends") {
  test::Random random{5};
  int ran = 0;
  for (std::uint64_t seed = 0; seed < 600; ++seed) {
    CAPTURE(seed);
    try {
      test::run_any_shader(damaged_spirv(test::RandomSpirv{seed % 40}.words(), random),
                           Isa::baseline);
      ++ran;
    } catch (const ShaderError&) {
    }
  }
  CHECK(ran > 20);
}

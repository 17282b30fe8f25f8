// --isa, on every vector unit that this CPU has.

#include "raster/lanes/isa.h"

#include "tests/support/cli_refused.h"
#include "tests/support/cli_render.h"

using namespace softfocus;

// Other methods: selftest_test.cpp, picture_methods_test.cpp and filter_isa_test.cpp.
TEST_CASE("render: the bytes are the same on every vector unit") {
  const auto on = [](Isa isa) {
    return rendered("cube-room", {"--max-coc", "6", "--isa", std::string{isa_name(isa)}});
  };
  const std::string scalar = on(Isa::scalar);
  for (const Isa isa : available_isas()) {
    CAPTURE(isa_name(isa));
    CHECK_UNARY(on(isa) == scalar);
  }
}

TEST_CASE("render: the report names the vector unit, the widest unless another is asked for") {
  CHECK(rendered_json("figures", {})["isa"] == isa_name(widest_isa()));
  CHECK(rendered_json("figures", {"--isa", "scalar"})["isa"] == "scalar");
}

TEST_CASE("render and selftest refuse a vector unit that this CPU has not, and list those it has") {
  const TemporaryDirectory directory;
  std::string there = "this CPU has scalar";
  for (const Isa isa : available_isas()) {
    if (isa != Isa::scalar) there.append(", ").append(isa_name(isa));
  }
  check_refused(directory, {"selftest", "--isa", "abacus"}, 2, {"--isa 'abacus'", there});
  check_refused(directory, render("figures", directory.file("a.png"), {"--isa", "abacus"}), 2,
                {"--isa 'abacus'", there});
}

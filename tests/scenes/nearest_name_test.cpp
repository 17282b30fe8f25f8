#include "scenes/files/scene_error.h"

#include <doctest/doctest.h>

#include <array>

using namespace softfocus;

TEST_CASE("an edit is a letter put in, left out or replaced, or two neighbours swapped") {
  CHECK(edit_distance("", "") == 0);
  CHECK(edit_distance("", "abc") == 3);
  CHECK(edit_distance("render", "render") == 0);
  CHECK(edit_distance("rendr", "render") == 1);
  CHECK(edit_distance("rrender", "render") == 1);
  CHECK(edit_distance("bender", "render") == 1);
  CHECK(edit_distance("redner", "render") == 1);
  CHECK(edit_distance("kitten", "sitting") == 3);
  CHECK(edit_distance("sitting", "kitten") == 3);
}

TEST_CASE("a slip of the finger is answered with the name that was meant, another name is not") {
  const std::array<std::string, 5> names{"--focus", "--f-number", "--frame", "-o", "accumulation"};
  CHECK(did_you_mean("--fnumber", names) == "; did you mean '--f-number'?");
  CHECK(did_you_mean("--fram", names) == "; did you mean '--frame'?");
  CHECK(did_you_mean("accumulatoin", names) == "; did you mean 'accumulation'?");
  CHECK(did_you_mean("accum", names) == "; did you mean 'accumulation'?");
  CHECK(did_you_mean("--f", names) == "");
  CHECK(did_you_mean("-x", names) == "");
  CHECK(did_you_mean("--nothing", names) == "");
  CHECK(did_you_mean("", names) == "");
  CHECK(did_you_mean("---", names) == "");
  CHECK(did_you_mean(std::string(1'000'000, 'a'), names) == "");
  CHECK(did_you_mean("x", {}) == "");
}

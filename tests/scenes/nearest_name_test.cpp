#include "scenes/files/scene_error.h"

#include <doctest/doctest.h>

#include <array>

using namespace softfocus;

TEST_CASE("what is printed has no control, no override of the direction and no broken UTF-8") {
  CHECK(printable("Gl\xC3\xBC\x63k \xE2\x82\xAC \xF0\x9F\x98\x80") ==
        "Gl\xC3\xBC\x63k \xE2\x82\xAC \xF0\x9F\x98\x80");
  CHECK(printable("a\nb\x1B[31m\x7F") == "a?b?[31m?");
  CHECK(printable("a\xC2\x9B"
                  "31m\xC2\xA0") == "a?31m\xC2\xA0");  // C1
  CHECK(printable("a\xE2\x80\xAE"
                  "b\xE2\x81\xA6\xD8\x9C") == "a?b??");   // overrides
  CHECK(printable("a\xE2\x80\xA8") == "a?");              // a line's end
  CHECK(printable("a\xC0\xAF\xFF\xE2\x82") == "a?????");  // no UTF-8
  CHECK(printable("\xED\xA0\x80\xF4\x90\x80\x80") == "???????");
}

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

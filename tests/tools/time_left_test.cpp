#include "tools/chart/time_left.h"

#include <doctest/doctest.h>

using namespace softfocus;

TEST_CASE("time left: the rest goes at the pace so far") {
  CHECK(TimeLeft::seconds(100, 25, 10) == 30.0);
  CHECK(TimeLeft::seconds(100, 100, 10) == 0.0);
  CHECK(TimeLeft::seconds(100, 120, 10) == 0.0);
  CHECK(TimeLeft::seconds(100, 0, 10) == 0.0);
}

TEST_CASE("time left: minutes, and below one tens of seconds, are rounded up") {
  CHECK(time_left_text(0) == "about 10 s left");
  CHECK(time_left_text(11) == "about 20 s left");
  CHECK(time_left_text(60) == "about 60 s left");
  CHECK(time_left_text(61) == "about 2 min left");
  CHECK(time_left_text(180) == "about 3 min left");
}

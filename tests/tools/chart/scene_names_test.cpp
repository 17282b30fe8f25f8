#include "tools/chart/options.h"

#include <doctest/doctest.h>

#include "tools/cli/errors.h"

using namespace softfocus;

using Names = std::vector<std::string>;

TEST_CASE("chart scenes: a range of seeds stands for a scene each, among other names") {
  CHECK(scene_names("figures,random:8..10,my.toml,random:3") ==
        Names{"figures", "random:8", "random:9", "random:10", "my.toml", "random:3"});
  CHECK(scene_names("random:7..7") == Names{"random:7"});
  CHECK(scene_names("random:64..127").size() == 64);
  CHECK(scene_names("random:18446744073709551614..18446744073709551615").size() == 2);
}

TEST_CASE("chart scenes: a name that is none, stands there twice or is no range is refused") {
  for (const char* wrong : {"", "a,,b", ",a", "a,", "a,a", "random:1..3,random:2", "random:3..1",
                            "random:1..", "random:..2", "random:a..b", "random:-1..2",
                            "random:1...2", "random:0..1000", "random:0..18446744073709551616"}) {
    CAPTURE(wrong);
    CHECK_THROWS_AS(scene_names(wrong), UsageError);
  }
  // A file's name may have dots.
  CHECK(scene_names("../a..b.toml") == Names{"../a..b.toml"});
}

TEST_CASE("chart scenes: no file's name has a colon") {
  CHECK(name_for_files("random:64") == "random-64");
  CHECK(name_for_files("figures") == "figures");
}

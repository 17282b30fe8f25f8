// compare with a tolerance: the status is by it, and the text says how far off.

#include <limits>

#include "raster/images/texel.h"
#include "tests/support/cli_refused.h"
#include "tests/support/cli_render.h"

using namespace softfocus;
using nlohmann::json;

namespace {

/// Grey 0.5 with depth 2, and the same with 3 half-ULPs more green and 8 more depth in a pixel.
struct TwoPictures {
  TemporaryDirectory directory;
  std::string a = directory.file("a.npy"), b = directory.file("b.npy");
  TwoPictures() {
    Image image = make_image(Format::rgba16f, 8, 8);
    clear_image(image, {0.5f, 0.5f, 0.5f, 2.0f}, {});
    write(a, image);
    row<std::uint16_t>(image, 3)[4 * 5 + 1] += 3;
    row<std::uint16_t>(image, 3)[4 * 5 + 3] += 8;
    write(b, image);
  }
  static void write(const std::string& name, const Image& image) {
    const Bytes bytes = encode_npy(image);
    write_file(name, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  }
  ProgramRun compared(const Words& more) const {
    Words words{"compare", a, b};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words);
  }
};

}  // namespace

TEST_CASE("compare: a limit that is kept is status 0, one that is broken 1") {
  const TwoPictures files;
  struct Case {
    const char *option, *kept, *broken;
  };
  // 3 half-ULPs from 0.5 are 3 * 2^-11 = 0.00146484; alpha counts for --max-ulps alone.
  for (const Case& limit : {Case{"--max-ulps", "8", "7"},
                            {"--max-error", "0.00146485", "0.00146484"},
                            {"--max-flip", "0.01", "0"}}) {
    CAPTURE(limit.option);
    CHECK(files.compared({limit.option, limit.kept}).status == 0);
    CHECK(files.compared({limit.option, limit.broken}).status == 1);
    CHECK(run_program({"compare", files.a, files.a, limit.option, "0"}).status == 0);
  }
  CHECK(files.compared({"--max-ulps", "8", "--max-error", "0.1"}).status == 0);
  CHECK(files.compared({"--max-ulps", "7", "--max-error", "0.1"}).status == 1);
}

TEST_CASE("compare: the text says which limit was kept or broken, and by how much") {
  const TwoPictures files;
  const std::string text = files.compared({"--max-ulps", "6", "--max-error", "0.5"}).out;
  CHECK(contains(text, "\nlargest error       0.00146484 (linear light)\n"));
  CHECK(contains(text, "\nlimit               --max-ulps 6: broken by 2, at 8 half-ULPs\n"));
  CHECK(
      contains(text, "\nlimit               --max-error 0.5: kept, 0.498535 below, at 0.00146484"));
}

TEST_CASE("compare: --json has the limits, what was found, and whether all were kept") {
  const TwoPictures files;
  const auto found =
      json::parse(files.compared({"--max-ulps", "6", "--max-flip", "1", "--json"}).out);
  CHECK(found["equal"] == false);
  CHECK(found["within_limits"] == false);
  CHECK(found["max_error"].get<double>() == 3.0 / 2048.0);
  REQUIRE(found["limits"].size() == 2);
  CHECK(found["limits"][0] ==
        json{{"option", "--max-ulps"}, {"limit", 6.0}, {"value", 8.0}, {"kept", false}});
  CHECK(found["limits"][1]["kept"] == true);
  CHECK(found["limits"][1]["value"] == found["flip"]);
  CHECK_FALSE(json::parse(files.compared({"--json"}).out).contains("limits"));
}

TEST_CASE("compare: a NaN against a number breaks every --max-error, a NaN against a NaN none") {
  const TwoPictures files;
  Image image = make_image(Format::rgba16f, 8, 8);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  clear_image(image, {nan, 0.5f, 0.5f, 2.0f}, {});
  const std::string c = files.directory.file("c.npy");
  TwoPictures::write(c, image);
  const Words limit{"--max-error", "1000000"};
  const ProgramRun run = run_program({"compare", files.a, c, limit[0], limit[1]});
  CHECK(run.status == 1);
  CHECK(contains(run.out, "--max-error 1e+06: broken by infinity, at infinity"));
  CHECK(run_program({"compare", c, c, "--max-error", "0"}).status == 0);
}

TEST_CASE("bad input: limits that are none, and with --flicker") {
  const TwoPictures files;
  for (const auto& [option, value] : {std::pair{"--max-ulps", "-1"},
                                      {"--max-ulps", "1.5"},
                                      {"--max-ulps", "65536"},
                                      {"--max-flip", "1.5"},
                                      {"--max-flip", "nan"},
                                      {"--max-error", "-0.1"},
                                      {"--max-error", "inf"}}) {
    check_refused(files.directory, {"compare", files.a, files.b, option, value}, 2,
                  {option, value});
  }
  check_refused(
      files.directory,
      {"compare", "--flicker", files.a, files.b, "--against", files.a, files.b, "--max-flip", "1"},
      2, {"--flicker", "--max-flip"});
}

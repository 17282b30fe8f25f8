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
    write_file(name, bytes);
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

TEST_CASE("compare --max-pixels: so many pixels may differ by more than --max-difference") {
  const TwoPictures files;
  CHECK(files.compared({"--max-pixels", "0"}).status == 1);
  CHECK(files.compared({"--max-pixels", "1"}).status == 0);
  CHECK(files.compared({"--max-pixels", "1.6%"}).status == 0);
  CHECK(files.compared({"--max-pixels", "1.5%"}).status == 1);
  // 3 half-ULPs from 0.5 are 0.00146484.
  CHECK(files.compared({"--max-difference", "0.00146485"}).status == 0);
  CHECK(files.compared({"--max-difference", "0.00146484"}).status == 1);
  const ProgramRun run = files.compared({"--max-pixels", "0"});
  CHECK(contains(run.out, "limit               --max-pixels 0: broken by 1, at 1 pixels"));
  for (const auto& [option, value] : {std::pair{"--max-pixels", "-1"},
                                      {"--max-pixels", "1.5"},
                                      {"--max-difference", "-1"},
                                      {"--search", "9"}}) {
    check_refused(files.directory, {"compare", files.a, files.b, option, value}, 2,
                  {option, value});
  }
}

TEST_CASE("compare --search: an edge that moved by a pixel is found, one that is new is not") {
  const TemporaryDirectory directory;
  const auto write_edge = [&](const std::string& name, int at, bool has_spot) {
    Image image = make_image(Format::rgba16f, 24, 16);
    for (int y = 0; y < 16; ++y) {
      for (int x = 0; x < 24; ++x) {
        const float light = x >= at || (has_spot && x == 3 && y == 9) ? 1.0f : 0.0f;
        store_texel(image, x, y, {light, light, light, 1.0f}, {});
      }
    }
    TwoPictures::write(directory.file(name), image);
    return directory.file(name);
  };
  const std::string a = write_edge("a.npy", 12, false), b = write_edge("b.npy", 13, false);
  const std::string c = write_edge("c.npy", 12, true);
  CHECK(run_program({"compare", a, b, "--max-pixels", "15"}).status == 1);
  CHECK(run_program({"compare", a, b, "--max-pixels", "16"}).status == 0);
  CHECK(run_program({"compare", a, b, "--search", "1"}).status == 0);
  CHECK(run_program({"compare", a, c, "--search", "1"}).status == 1);
  CHECK(run_program({"compare", c, a, "--search", "1"}).status == 1);
  CHECK(run_program({"compare", c, a, "--search", "1", "--max-pixels", "1"}).status == 0);
}

TEST_CASE("compare: colours under an alpha of 0 do not count, and alpha does") {
  const TemporaryDirectory directory;
  const auto write_png = [&](const std::string& name, float hidden, float alpha) {
    Image image = make_image(Format::rgba16f, 8, 8);
    clear_image(image, {0.5f, 0.5f, 0.5f, 1.0f}, {});
    // What is transparent keeps its colour only if it was not multiplied: 1e-7 is 0 in 8 bits.
    const float part = alpha > 0.0f ? alpha : 1e-7f;
    std::vector<float> opacity(64, 1.0f);
    std::fill_n(opacity.begin(), 32, part);
    for (int i = 0; i < 32; ++i) {
      store_texel(image, i % 8, i / 8, {hidden * part, 0.0f, 0.0f, 1.0f}, {});
    }
    write_file(directory.file(name), encode_png(image, opacity));
    return directory.file(name);
  };
  const std::string a = write_png("a.png", 0.2f, 0.0f), b = write_png("b.png", 0.9f, 0.0f);
  REQUIRE(load_texel(read_image_file(a).image, 0, 0).x !=
          load_texel(read_image_file(b).image, 0, 0).x);
  CHECK(run_program({"compare", a, b}).status == 0);
  CHECK(run_program({"compare", a, write_png("c.png", 0.2f, 1.0f), "--max-pixels", "31"}).status ==
        1);
}

TEST_CASE("compare: the last line says how to go on where the pictures differ, and nowhere else") {
  const TwoPictures files;
  CHECK(contains(files.compared({}).out,
                 "--diff OUT.png draws the difference; cp '" + files.a + "' '" + files.b + "'"));
  const std::string map = files.directory.file("d.png");
  CHECK(contains(files.compared({"--diff", map}).out, "the difference is drawn in '" + map + "'"));
  CHECK_FALSE(contains(files.compared({"--max-pixels", "1"}).out, "to go on"));
  CHECK_FALSE(contains(run_program({"compare", files.a, files.a}).out, "to go on"));
}

TEST_CASE("compare --regions: an empty region is said, and focus fits the picture") {
  const TemporaryDirectory directory;
  const std::string a = directory.file("a.npy");
  Image image = make_image(Format::rgba16f, 32, 32);
  clear_image(image, {0.5f, 0.5f, 0.5f, 2.0f}, {});
  TwoPictures::write(a, image);
  const Words lens{"compare", a, a, "--regions", "--f-number", "1", "--coc-scale", "50"};
  Words far = lens, near = lens;
  far.insert(far.end(), {"--focus", "2"});
  near.insert(near.end(), {"--focus", "20"});
  CHECK(contains(run_program(far).out, "no pixel of the picture lies there"));
  CHECK_FALSE(contains(run_program(far).out, "here up to a radius of"));
  const std::string text = run_program(near).out;
  CHECK(contains(text, "here up to a radius of"));
  CHECK(contains(text, "focus                1024"));
}

// softfocus refocus: depths as cameras, networks and renderers give them.

#include <cmath>
#include <functional>

#include "raster/images/texel.h"
#include "tests/support/cli_refused.h"
#include "tests/support/cli_render.h"
#include "tools/pictures/exr_file.h"
#include "tools/pictures/picture_file.h"

using namespace softfocus;
using nlohmann::json;

namespace {

constexpr int kAcross = 64, kDown = 48;

void put(const TemporaryDirectory& directory, const std::string& name, const Bytes& bytes) {
  write_file(directory.file(name), bytes);
}

/// A picture of black and white squares.
Image squares(int width, int height) {
  Image picture = make_image(Format::rgba16f, width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float grey = (x / 4 + y / 4) % 2 == 0 ? 0.1f : 0.8f;
      store_texel(picture, x, y, {grey, grey, grey, 1.0f}, {});
    }
  }
  return picture;
}

/// Numbers of a map: the left half is one thing, the right half another.
std::vector<float> halves(float left, float right, int width = kAcross, int height = kDown) {
  std::vector<float> values(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  int i = 0;
  for (float& value : values) value = i++ % width < width / 2 ? left : right;
  return values;
}

Bytes grey_png(const std::vector<float>& values, int width = kAcross, int height = kDown) {
  return encode_grey_png_16(std::vector<std::uint16_t>(values.begin(), values.end()), width,
                            height);
}

struct Told {
  json report;
  std::string err;
};

Told refocused(const TemporaryDirectory& directory, const Words& files, const Words& more) {
  Words words{"refocus"};
  for (const std::string& file : files) words.push_back(directory.file(file));
  words.insert(words.end(), {"-o", directory.file("o.npy"), "--json"});
  words.insert(words.end(), more.begin(), more.end());
  const ProgramRun run = run_program(words);
  CAPTURE(run.err);
  REQUIRE(run.status == 0);
  return {json::parse(run.out), run.err};
}

float red_in_result(const TemporaryDirectory& directory, int x, int y) {
  return load_texel(read_image_file(directory.file("o.npy")).image, x, y).x;
}

double depth_in_result(const TemporaryDirectory& directory, int x, int y) {
  return static_cast<double>(load_texel(read_image_file(directory.file("o.npy")).image, x, y).w);
}

}  // namespace

TEST_CASE("refocus: what is believed of the depth, and its range, is a line unless -q says none") {
  const TemporaryDirectory directory;
  put(directory, "c.npy", encode_npy(squares(kAcross, kDown)));
  put(directory, "d.png", grey_png(halves(384, 1536)));
  const Told told = refocused(directory, {"c.npy", "d.png"}, {});
  CHECK(tells_depth_alone(told.err));
  CHECK(contains(told.err, "millimetres, 0.384 m to 1.536 m (believed: 16 bits"));
  CHECK(contains(told.report["depth_believed"].get<std::string>(), "kitti"));
  CHECK(refocused(directory, {"c.npy", "d.png"}, {"-q"}).err == "");
  const Told said = refocused(directory, {"c.npy", "d.png"}, {"--depth-encoding", "kitti"});
  CHECK(contains(said.err, "the depth is kitti, 1.5 m to 6 m\n"));
  CHECK(said.report["depth_believed"].is_null());
  CHECK(said.report["farthest_m"] == 6.0);
  put(directory, "sun.png", grey_png(halves(1500 << 3, 6000 << 3)));
  CHECK(contains(refocused(directory, {"c.npy", "sun.png"}, {"--depth-encoding", "sun-rgb-d"}).err,
                 "1.5 m to 6 m"));
  CHECK(contains(
      refocused(directory, {"c.npy", "d.png"}, {"--depth-encoding", "metres", "--scale", "0.00025"})
          .err,
      "0.096 m to 0.384 m"));
}

TEST_CASE("refocus: a guess that puts half of it beyond 100 m, or within 1 cm, warns") {
  const TemporaryDirectory directory;
  put(directory, "c.npy", encode_npy(squares(kAcross, kDown)));
  const auto err_of = [&](float left, float right, const Words& more) {
    put(directory, "d.pfm", encode_grey_pfm(halves(left, right), kAcross, kDown));
    return refocused(directory, {"c.npy", "d.pfm"}, more).err;
  };
  for (const float odd : {237.0f, 0.003f}) {
    const std::string err = err_of(odd, 2.0f, {});
    CHECK(contains(err, "warning: "));
    CHECK(contains(err, odd > 1.0f ? "50 % beyond 100 m" : "50 % within 1 cm"));
    CHECK(contains(err, "midas"));
    CHECK(tells_depth_alone(err_of(odd, 2.0f, {"--depth-encoding", "metres"})));
  }
  CHECK(tells_depth_alone(err_of(2.0f, 90.0f, {})));
  CHECK(tells_depth_alone(err_of(2.0f, INFINITY, {})));  // the sky
}

TEST_CASE("refocus: frames tell of the first one's depth") {
  const TemporaryDirectory directory;
  for (const std::string frame : {"1", "2", "3"}) {
    put(directory, "c" + frame + ".npy", encode_npy(squares(kAcross, kDown)));
  }
  put(directory, "d.pfm", encode_grey_pfm(halves(2, 5), kAcross, kDown));
  const ProgramRun run = run_program({"refocus", directory.file("c%d.npy"), directory.file("d.pfm"),
                                      "-o", directory.file("o%d.npy")});
  CHECK(run.status == 0);
  const auto place = run.err.find("the depth is metres, 2 m to 5 m");
  CHECK(place != run.err.npos);
  CHECK(run.err.find("the depth is", place + 1) == run.err.npos);
}

TEST_CASE("refocus: a background of depth 0 is as blurred as one that is infinitely far") {
  const TemporaryDirectory directory;
  put(directory, "c.npy", encode_npy(squares(kAcross, kDown)));
  put(directory, "zero.pfm", encode_grey_pfm(halves(1.5f, 0), kAcross, kDown));
  put(directory, "sky.pfm", encode_grey_pfm(halves(1.5f, INFINITY), kAcross, kDown));
  put(directory, "zero.png", grey_png(halves(1500, 0)));
  const Words lens{"--focus", "1.5", "--f-number", "1"};
  const Told sky = refocused(directory, {"c.npy", "sky.pfm"}, lens);
  for (const std::string file : {"zero.pfm", "zero.png"}) {
    CAPTURE(file);
    const Told zero = refocused(directory, {"c.npy", file}, lens);
    CHECK(zero.report["picture_hash"] == sky.report["picture_hash"]);
    CHECK(zero.report["filled_pixels"] == kAcross * kDown / 2);
    CHECK(zero.report["background_pixels"] == kAcross * kDown / 2);
    CHECK(contains(zero.err, "; 50 % have none and are background"));
  }
  Words far = lens;
  far.insert(far.end(), {"--holes", "far"});
  const Told filled = refocused(directory, {"c.npy", "zero.pfm"}, far);
  CHECK(filled.report["background_pixels"] == 0);
  CHECK(contains(filled.err, "filled from the far side"));
  CHECK(depth_in_result(directory, 60, 20) == 1.5);
}

TEST_CASE("refocus: where the middle is background, the nearest is in focus by default") {
  const TemporaryDirectory directory;
  put(directory, "c.npy", encode_npy(squares(kAcross, kDown)));
  std::vector<float> depth(kAcross * kDown, 0.0f);
  for (int i = 0; i < kAcross * kDown; ++i) {
    if (i % kAcross < 12) depth[static_cast<std::size_t>(i)] = 2.5f;
  }
  put(directory, "d.pfm", encode_grey_pfm(depth, kAcross, kDown));
  const Told told = refocused(directory, {"c.npy", "d.pfm"}, {});
  CHECK(told.report["focus_m"] == 2.5);
  CHECK(contains(told.report["focus_from"].get<std::string>(), "the nearest"));
  check_refused(directory,
                {"refocus", directory.file("c.npy"), directory.file("d.pfm"), "-o",
                 directory.file("p.npy"), "--autofocus"},
                2, {"nothing there has a finite depth"});
  CHECK(refocused(directory, {"c.npy", "d.pfm"}, {"--autofocus", "3,20"}).report["focus_m"] == 2.5);
}

TEST_CASE("refocus: a depth of nearly the picture's shape is stretched, and told") {
  const TemporaryDirectory directory;
  put(directory, "c.npy", encode_npy(squares(256, 144)));
  const auto put_depth = [&](int width, int height) {
    put(directory, "d.pfm", encode_grey_pfm(halves(2, 5, width, height), width, height));
  };
  put_depth(186, 103);
  const Told told = refocused(directory, {"c.npy", "d.pfm"}, {});
  CHECK(contains(told.err, "; 186x103 pixels are stretched to the picture's shape, by 1.6 %"));
  CHECK(depth_in_result(directory, 124, 30) == 2.0);
  CHECK(depth_in_result(directory, 132, 30) == 5.0);
  put_depth(64, 48);
  const Words words{"refocus", directory.file("c.npy"), directory.file("d.pfm"), "-o",
                    directory.file("p.npy")};
  check_refused(directory, words, 2, {"64x48", "256x144", "--depth-fit stretch or crop"});
  CHECK(contains(refocused(directory, {"c.npy", "d.pfm"}, {"--depth-fit", "stretch"}).err,
                 "by 33.3 %"));
  CHECK(contains(refocused(directory, {"c.npy", "d.pfm"}, {"--depth-fit", "crop"}).err,
                 "the middle 64x36 of 64x48 pixels"));
}

TEST_CASE("refocus: --depth-fit crop takes the middle of the depth, as a picture of it shows it") {
  const TemporaryDirectory directory;
  put(directory, "c.npy", encode_npy(squares(kAcross, kDown)));
  std::vector<float> wide(std::size_t{80} * kDown);
  int i = 0;
  for (float& value : wide) value = 1.0f + static_cast<float>(i++ % 80);
  put(directory, "d.pfm", encode_grey_pfm(wide, 80, kDown));
  refocused(directory, {"c.npy", "d.pfm"}, {"--depth-fit", "crop", "--depth-encoding", "metres"});
  for (const int x : {0, 31, 63}) CHECK(depth_in_result(directory, x, 7) == 1.0 + 8 + x);
}

TEST_CASE("refocus: --circles has the circles of a lens that has them") {
  const TemporaryDirectory directory;
  put(directory, "c.npy", encode_npy(squares(kAcross, kDown)));
  put(directory, "sky.pfm", encode_grey_pfm(halves(INFINITY, INFINITY), kAcross, kDown));
  put(directory, "r.pfm", encode_grey_pfm(halves(5, 5), kAcross, kDown));
  const Words method{"--method", "scatter-aperture"};
  Words lens = method;
  lens.insert(lens.end(),
              {"--focus", "2", "--blur-at-infinity", "5", "--depth-encoding", "metres"});
  refocused(directory, {"c.npy", "sky.pfm"}, lens);
  std::vector<float> expected;
  expected.reserve(kAcross);
  for (int x = 0; x < kAcross; ++x) expected.push_back(red_in_result(directory, x, 20));
  Words circles = method;
  circles.insert(circles.end(), {"--circles", directory.file("r.pfm")});
  const Told told = refocused(directory, {"c.npy"}, circles);
  CHECK(contains(told.err, "the circles are 5 to 5 px radius"));
  CHECK(told.report["largest_circle_px"] == 5.0);
  CHECK(told.report["lens"].is_null());
  CHECK(told.report["nearest_m"].is_null());
  for (int x = 0; x < kAcross; ++x) {
    CHECK(red_in_result(directory, x, 20) ==
          doctest::Approx(expected[static_cast<std::size_t>(x)]).epsilon(0.005));
  }
  CHECK(depth_in_result(directory, 3, 3) == 0.0);  // none is known
}

TEST_CASE("refocus: --circles before the focus spread over what is sharp, those behind do not") {
  const TemporaryDirectory directory;
  Image white_left = make_image(Format::rgba16f, kAcross, kDown);
  for (int i = 0; i < kAcross * kDown; ++i) {
    const float grey = i % kAcross < kAcross / 2 ? 1.0f : 0.0f;
    store_texel(white_left, i % kAcross, i / kAcross, {grey, grey, grey, 1.0f}, {});
  }
  put(directory, "c.npy", encode_npy(white_left));
  const auto red_beside = [&](float radius) {
    put(directory, "r.pfm", encode_grey_pfm(halves(radius, 0), kAcross, kDown));
    refocused(directory, {"c.npy"},
              {"--method", "disc-layers", "--circles", directory.file("r.pfm")});
    return red_in_result(directory, kAcross / 2 + 1, 20);
  };
  CHECK(red_beside(-6.0f) > 0.2f);
  CHECK(red_beside(6.0f) < 0.02f);
}

TEST_CASE("refocus: --circles give the same picture by rows and whole, and take our own EXR's") {
  const TemporaryDirectory directory;
  put(directory, "c.npy", encode_npy(squares(kAcross, kDown)));
  put(directory, "r.pfm", encode_grey_pfm(halves(-3, 4.5f), kAcross, kDown));
  const Words circles{"--circles", directory.file("r.pfm"), "--method", "two-pass"};
  const Told rows = refocused(directory, {"c.npy"}, circles);
  CHECK(rows.report["by_rows"] == true);
  Words whole{"refocus", directory.file("c.npy"), "-o", directory.file("o.png"), "--json"};
  whole.insert(whole.end(), circles.begin(), circles.end());
  CHECK(json::parse(run_program(whole).out)["picture_hash"] == rows.report["picture_hash"]);
  if (!missing_exr().empty()) return;
  whole[3] = directory.file("o.exr");
  CHECK(run_program(whole).status == 0);
  CHECK(plane_names(open_picture_file(directory.file("o.exr"))) == "A, B, G, R, coc");
  const Told again = refocused(directory, {"c.npy"},
                               {"--circles", directory.file("o.exr"), "--method", "two-pass"});
  CHECK(contains(again.err, "the circles are -3 to 4.5 px radius"));
}

TEST_CASE("bad input: --circles beside a depth, an encoding or a lens") {
  const TemporaryDirectory directory;
  put(directory, "c.npy", encode_npy(squares(8, 8)));
  const std::string c = directory.file("c.npy"), out = directory.file("p.npy");
  check_refused(directory, {"refocus", c, c, "--circles", c, "-o", out}, 2,
                {"--circles", "DEPTH", "exclude"});
  for (const std::string option : {"--focus", "--f-number", "--fov", "--near"}) {
    check_refused(directory, {"refocus", c, "--circles", c, "-o", out, option, "2"}, 2,
                  {"--circles", option, "exclude"});
  }
}

TEST_CASE("refocus: - is standard input, for the picture or for the depth") {
  const TemporaryDirectory directory;
  const std::string colour = directory.file("c.npy"), depth = directory.file("d.pfm");
  put(directory, "c.npy", encode_npy(squares(kAcross, kDown)));
  put(directory, "d.pfm", encode_grey_pfm(halves(2, 5), kAcross, kDown));
  const auto hash_of = [&](const std::string& first, const std::string& second,
                           const std::string& input) {
    const ProgramRun run = run_program(
        {"refocus", first, second, "-o", directory.file("o.png"), "--json"}, {.in_from = input});
    CAPTURE(run.err);
    REQUIRE(run.status == 0);
    return json::parse(run.out)["picture_hash"].get<std::string>();
  };
  const std::string expected = hash_of(colour, depth, "/dev/null");
  CHECK(hash_of("-", depth, colour) == expected);
  CHECK(hash_of(colour, "-", depth) == expected);
  check_refused(directory, {"refocus", "-", "-", "-o", directory.file("p.png")}, 2,
                {"standard input is one file"});
  check_refused(directory,
                {"refocus", "-", depth, "-o", directory.file("p%d.png"), "--frames", "1..3"}, 2,
                {"COLOUR -", "standard input"});
}

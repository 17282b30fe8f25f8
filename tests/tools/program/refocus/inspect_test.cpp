// softfocus inspect: what is in pictures' files.

#include <algorithm>
#include <cmath>

#include "raster/images/texel.h"
#include "tests/support/cli_refused.h"
#include "tests/support/cli_render.h"
#include "tools/pictures/image_file.h"

using namespace softfocus;
using nlohmann::json;

namespace {

void write_pfm(const std::string& name, const std::vector<float>& values, int width, int height) {
  const Bytes bytes = encode_grey_pfm(values, width, height);
  write_file(name, bytes);
}

json inspected_json(Words words) {
  words.insert(words.begin(), "inspect");
  words.emplace_back("--json");
  const ProgramRun run = run_program(words);
  REQUIRE(run.status == 0);
  return json::parse(run.out);
}

}  // namespace

TEST_CASE("inspect: planes, types, ranges and the believed depth of a file") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("a.npy");
  CHECK(run_program(render("figures", file, {"--show", "pinhole"})).status == 0);
  const ProgramRun run = run_program({"inspect", file});
  CHECK(run.status == 0);
  CHECK(run.err == "");
  for (const char* part : {"NumPy, 48x32, linear", "R ", "half", "colour: without a layer's name",
                           "depth: A, read as metres (softfocus wrote it, in metres)",
                           "0 of 1536 pixels without a depth", " m "}) {
    CAPTURE(part);
    CHECK(contains(run.out, part));
  }
}

TEST_CASE("inspect: the histogram counts every pixel once, infinite ones apart") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("d.pfm");
  std::vector<float> metres(100, INFINITY);
  for (std::size_t i = 0; i < 60; ++i) metres[i] = 1.0f + static_cast<float>(i) / 10.0f;
  metres[70] = NAN;
  write_pfm(file, metres, 10, 10);
  const json found = inspected_json({file})[0]["depth"];
  CHECK(found["encoding"] == "metres");
  CHECK(found["missing"] == 1);
  CHECK(found["infinite"] == 39);
  int counted = 0;
  for (const json& bin : found["histogram"]) counted += bin["count"].get<int>();
  CHECK(counted == 60);
  CHECK(found["histogram"].front()["from"] == 1.0);
  CHECK(found["histogram"].back()["to"].get<double>() == doctest::Approx(6.9));
}

TEST_CASE("inspect: what cannot be told is said, with what it may be") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("d.pfm");
  write_pfm(file, {0.0f, 0.25f, 0.5f, 1.0f}, 2, 2);
  const json found = inspected_json({file})[0]["depth"];
  CHECK(found["encoding"].is_null());
  CHECK(contains(found["why"].get<std::string>(), "device"));
  const json said =
      inspected_json({file, "--depth-encoding", "device", "--near", "1", "--far", "9"})[0]["depth"];
  CHECK(said["in_metres"] == true);
  CHECK(said["histogram"].back()["to"].get<double>() == doctest::Approx(9.0));
}

TEST_CASE("inspect: of numbers that cannot be told the histogram counts 0 and what is below") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("d.pfm");
  write_pfm(file, {-1.0f, 0.0f, 0.0f, 0.5f, NAN, INFINITY}, 3, 2);
  const json found = inspected_json({file})[0]["depth"];
  CHECK(found["encoding"].is_null());
  CHECK(found["missing"] == 1);
  CHECK(found["infinite"] == 1);
  CHECK(found["histogram"].front()["from"] == -1.0);
  int counted = 0;
  for (const json& bin : found["histogram"]) counted += bin["count"].get<int>();
  CHECK(counted == 4);
}

TEST_CASE("inspect: a depth in three equal channels is one, as refocus takes it") {
  const TemporaryDirectory directory;
  Image grey = make_image(Format::rgba16f, 4, 3);
  for (int i = 0; i < 12; ++i)
    store_texel(grey, i % 4, i / 4, glm::vec4{0.1f * static_cast<float>(i % 4)}, {});
  const auto put = [&](const std::string& name) {
    const Bytes bytes = encode_png(grey);
    write_file(directory.file(name), bytes);
    return inspected_json({directory.file(name)})[0]["depth"];
  };
  const json depth = put("grey.png");
  REQUIRE(!depth.is_null());
  CHECK(depth["plane"] == "R");
  CHECK(depth["missing"] == 0);
  store_texel(grey, 0, 0, {1.0f, 0.0f, 0.0f, 0.0f}, {});
  CHECK(put("colour.png").is_null());
}

TEST_CASE("inspect, refocus: a depth without a known number is said to be none") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("d.pfm");
  write_pfm(file, {NAN, NAN}, 2, 1);
  CHECK(contains(run_program({"inspect", file}).out, "not to be told: all its numbers are NaN"));
  check_refused(directory, {"refocus", file, file, "-o", directory.file("o.png")}, 2,
                {"d.pfm", "has no depth", "another file"});
  write_pfm(file, {INFINITY, NAN}, 2, 1);
  CHECK(contains(run_program({"inspect", file}).out, "no number is finite"));
  write_pfm(file, {0.25f, 1.0f}, 2, 1);
  CHECK(contains(run_program({"inspect", file}).out, "what a network gives (midas)"));
}

TEST_CASE("inspect: -o shows the circles, black where it is sharp") {
  const TemporaryDirectory directory;
  const std::string colour = directory.file("a.png"), depth = directory.file("d.pfm");
  CHECK(run_program(render("figures", colour, {"--show", "pinhole", "--depth-output", depth}))
            .status == 0);
  const ProgramRun run = run_program({"inspect", colour, depth, "--focus", "20", "--f-number",
                                      "0.5", "-o", directory.file("c.npy")});
  CHECK(run.status == 0);
  CHECK(contains(run.err, "black is sharp"));
  const Image circles = read_image_file(directory.file("c.npy")).image;
  CHECK(load_texel(circles, 0, 0).x == 0.0f);  // the background, 20 m away
  float most = 0.0f;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) most = std::max(most, load_texel(circles, x, y).x);
  }
  CHECK(most > 0.5f);
}

TEST_CASE("bad input: inspect without a file, of no picture, with an -o that is an input") {
  const TemporaryDirectory directory;
  write_file(directory.file("a.png"), "no picture");
  check_refused(directory, {"inspect"}, 2, {"FILES is missing"});
  check_refused(directory, {"inspect", directory.file("a.png")}, 1, {"a.png", "none of PNG"});
  check_refused(directory, {"inspect", directory.file("none")}, 1, {"none", "cannot read"});
}

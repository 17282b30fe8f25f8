// softfocus relief, from end to end.

#include <doctest/doctest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "raster/images/texel.h"
#include "scenes/traced_relief/traced_relief.h"
#include "tests/support/cli_refused.h"
#include "tests/support/skip.h"
#include "tools/pictures/image_file.h"

using namespace softfocus;

namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

std::string relief_by(const TemporaryDirectory& folder, const Words& more = {}) {
  std::string file = folder.file("a.relief");
  Words words{"relief", "make", "figures", "--texels", "48x40", "-o", file};
  words.insert(words.end(), more.begin(), more.end());
  const ProgramRun run = run_program(words);
  CHECK(run.err == "");
  REQUIRE(run.status == 0);
  return file;
}

}  // namespace

TEST_CASE("relief: a scene's relief is made, shown and warped") {
  const TemporaryDirectory folder;
  const std::string relief = relief_by(folder, {"--normals", "--depth-bits", "16"});
  for (const char* part : {"image", "depth", "normals"}) {
    const std::string picture = folder.file(std::string{part} + ".npy");
    const ProgramRun run = run_program({"relief", "show", relief, "--show", part, "-o", picture});
    CHECK(run.err == "");
    REQUIRE(run.status == 0);
    const Image image = read_image_file(picture).image;
    CHECK(image.width == 48);
    CHECK(image.height == 40);
  }
  const std::string first = folder.file("first.npy"), second = folder.file("second.npy");
  const ProgramRun run = run_program(
      {"relief", "warp", relief, "--yaw", "10", "--size", "64x64", "--threads", "1", "-o", first});
  REQUIRE(run.status == 0);
  CHECK(contains(run.err, " texels; "));
  CHECK(contains(run.err, " over others, "));
  REQUIRE(run_program({"relief", "warp", relief, "--yaw", "10", "--size", "64x64", "--threads", "3",
                       "-o", second})
              .status == 0);
  CHECK(hash_image(read_image_file(first).image) == hash_image(read_image_file(second).image));
}

TEST_CASE("a camera that meets its target on its way is refused at that frame alone") {
  const TemporaryDirectory folder;
  const std::string scene = folder.file("through.toml");
  write_file(scene,
             "[camera]\nposition = [[0, 0, 0, 5], [10, 0, 0, -5]]\n[material.m]\n"
             "[[object]]\nshape = \"cube\"\nmaterial = \"m\"\n");
  const auto at = [&](const char* frame) {
    return run_program({"render", scene, "--frame", frame, "--size", "16x16", "--show", "pinhole",
                        "-o", folder.file("a.npy")});
  };
  CHECK(at("4").status == 0);
  const ProgramRun refused = at("5");
  CHECK(refused.status == 2);
  CHECK(contains(refused.err, "frame 5: the camera of '" + scene + "' stands at its target"));
}

TEST_CASE("relief walk draws a scene with its impostors and without") {
  const TemporaryDirectory folder;
  write_file(folder.file("walk.toml"),
             "[camera]\nposition = [[0, 0, 1, 6], [10, 1, 1, 6]]\n[material.m]\n"
             "[[object]]\nshape = \"torus\"\nsegments = 200\nsides = 100\nmaterial = \"m\"\n"
             "impostor = true\n");
  const std::string scene = folder.file("walk.toml");
  const Words words{"relief",
                    "walk",
                    scene,
                    "--frames",
                    "4",
                    "--every",
                    "2",
                    "--size",
                    "64x64",
                    "-o",
                    folder.file("walk_%d.png")};
  const ProgramRun run = run_program(words);
  CHECK(run.err == "");
  REQUIRE(run.status == 0);
  CHECK(contains(run.out, "triangles 40000, frames 4, size 64x64"));
  CHECK(read_image_file(folder.file("walk_2.png")).image.width == 128);
  Words as_json{words.begin(), words.end() - 2};
  as_json.push_back("--json");
  const json found = json::parse(run_program(as_json).out);
  REQUIRE(found.at("curve").size() == 4);
  CHECK(found.at("curve")[0].at("renewed") == 1);
  CHECK(found.at("curve")[0].at("flip") < 0.02);
  CHECK(found.at("curve")[1].contains("jump"));
  CHECK(found.at("tenths").size() == 4);
  CHECK(found.at("impostors").at("most_megabytes") > 0.0);

  const ProgramRun without = run_program(
      {"relief", "walk", "figures", "--frames", "4", "--every", "4", "--size", "32x32"});
  REQUIRE(without.status == 0);
  CHECK(contains(without.err, "no object of 'figures' is an impostor"));
  const ProgramRun refused = run_program({"relief", "walk", scene, "--tolerance", "4"});
  CHECK(refused.status == 2);
  CHECK(contains(refused.err, "--tolerance: relief walk does not read it"));
}

TEST_CASE("the wood of docs/examples is a scene whose trees are impostors") {
  if (std::system("python3 --version >/dev/null 2>&1") != 0) return skip("numpy", "no python3");
  const TemporaryDirectory folder;
  const std::string script = "python3 " SOFTFOCUS_TEST_DATA "/../../docs/examples/wood.py " +
                             folder.file("wood") + " 6 0.3";
  REQUIRE(std::system(script.c_str()) == 0);
  const ProgramRun run =
      run_program({"relief", "walk", folder.file("wood") + "/wood.toml", "--frames", "4", "--every",
                   "2", "--size", "96x96", "--json"});
  CHECK(run.err == "");
  REQUIRE(run.status == 0);
  const json found = json::parse(run.out);
  CHECK(found.at("triangles") > 20000);
  for (const json& point : found.at("curve")) {
    const int all = point.at("shown").get<int>() + point.at("as_geometry").get<int>() +
                    point.at("out_of_view").get<int>();
    CHECK(all == 6);
  }
  CHECK(found.at("impostors").at("most_flip") < 0.03);
}

TEST_CASE("relief bench and turn say what they measured") {
  const TemporaryDirectory folder;
  const std::string relief = relief_by(folder);
  const ProgramRun bench = run_program({"relief", "bench", relief, "--runs", "2", "--yaw", "15"});
  CHECK(bench.err == "");
  REQUIRE(bench.status == 0);
  for (const char* part : {"two-pass", "asymmetric", "compensated", "intertwined", "49.6"}) {
    CHECK(contains(bench.out, part));
  }
  const Words by_json{"relief", "bench", relief, "--runs", "2", "--yaw", "15", "--json"};
  const json timed = json::parse(run_program(by_json).out);
  CHECK(timed.at("resamplings").size() == 4);
  CHECK(timed.at("resamplings")[0].at("name") == "two-pass");
  CHECK(timed.at("slices").size() == 5);
  CHECK(timed.at("times").size() == 2);
  const Words turning{"relief",
                      "turn",
                      "figures",
                      "--frames",
                      "12",
                      "--every",
                      "6",
                      "--size",
                      "96x96",
                      "-o",
                      folder.file("t_%02d.npy")};
  const ProgramRun turn = run_program(turning);
  CHECK(turn.err == "");
  REQUIRE(turn.status == 0);
  CHECK(turn.out.starts_with("verdict: impostor "));
  CHECK(contains(turn.out, "times as "));
  CHECK(contains(turn.out, "renewals "));
  CHECK(contains(turn.out, "errors: flip "));
  Words turning_json = turning;
  turning_json.emplace_back("--json");
  const json turned = json::parse(run_program(turning_json).out);
  CHECK(turned.at("frames") == 12);
  CHECK(turned.at("steps").at("renewals") > 0);
  const std::string verdict = turned.at("verdict").at("impostor");
  const bool is_faster = turned.at("frame_ms").at("ratio") > 1.0;
  CHECK(verdict.starts_with(is_faster ? "pays: " : "does not pay: "));
  CHECK(contains(verdict, is_faster ? "times as fast" : "times as slow"));
  CHECK(contains(verdict, " of 12 frames "));
  for (const char* part : {"frame_ms", "schedule", "errors", "bound_by_largest"}) {
    CHECK(turned.at(part).is_object());
  }
  const Image pair = read_image_file(folder.file("t_06.npy")).image;
  CHECK(pair.width == 192);
  CHECK(pair.height == 96);
}

TEST_CASE("relief: a picture of heights becomes a relief, with holes where it says so") {
  const TemporaryDirectory folder;
  std::vector<std::uint16_t> heights;
  heights.reserve(20 * 10);
  for (int i = 0; i < 200; ++i) heights.push_back(static_cast<std::uint16_t>(300 * (i % 20)));
  const auto put = [&](const char* name, const Bytes& bytes) {
    std::string file = folder.file(name);
    write_file(file, bytes);
    return file;
  };
  const std::string grey = put("h.png", encode_grey_png_16(heights, 20, 10));
  const std::string red = put("red.png", encode_png(make_image(Format::rgba16f, 20, 10)));
  const std::string small = put("small.png", encode_png(make_image(Format::rgba16f, 9, 9)));
  const std::string file = folder.file("h.relief"), picture = folder.file("h.npy");
  const ProgramRun run = run_program({"relief", "make", "--height-field", grey, "--colour", red,
                                      "--empty", "600", "--height", "0.5", "-o", file});
  CHECK(run.err == "");
  REQUIRE(run.status == 0);
  REQUIRE(run_program({"relief", "show", file, "--show", "depth", "-o", picture}).status == 0);
  const Image depths = read_image_file(picture).image;
  CHECK(depths.width == 20);
  CHECK(load_texel(depths, 19, 3).x == 1.0f);  // the highest
  CHECK(load_texel(depths, 0, 3).x == 0.0f);   // the lowest
  CHECK(load_texel(depths, 2, 3).w == 0.0f);   // a hole
  const std::string to = folder.file("to.relief");
  check_refused(folder, {"relief", "make", "--height-field", grey, "--colour", small, "-o", to}, 1,
                {"small.png", "9x9", "20x10"});
  check_refused(folder, {"relief", "make", "figures", "--colour", red, "-o", to}, 2,
                {"--colour", "--height-field"});
  check_refused(folder, {"relief", "make", "--height-field", grey, "--yaw", "3", "-o", to}, 2,
                {"--yaw", "--height-field"});
  check_refused(folder, {"relief", "make", "--height-field", red, "--empty", "0", "-o", to}, 1,
                {"red.png", "no height"});
  check_refused(folder, {"relief", "make", "--height-field", grey, "-o", grey}, 2,
                {"-o", "the heights"});
  check_refused(folder, {"relief", "make", "--height-field", grey, "--unlit", "-o", to}, 2,
                {"--unlit", "--height-field"});
  // Such a file would be refused when it is read.
  for (int i = 0; i < 200; ++i)
    heights[static_cast<std::size_t>(i)] = static_cast<std::uint16_t>(i % 2);
  const std::string even = put("even.png", encode_grey_png_16(heights, 20, 10));
  check_refused(folder, {"relief", "make", "--height-field", even, "--height", "1e-6", "-o", to}, 2,
                {"even.png", "1e-9 m"});
}

TEST_CASE("relief: no scene is written over, and no picture has text in it") {
  const TemporaryDirectory folder;
  const std::string model = folder.file("a.obj");
  write_file(model, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  check_refused(folder, {"relief", "make", model, "-o", model}, 2, {"-o", "a file of the scene"});
  const ProgramRun run =
      run_program({"relief", "box", "figures", "--texels", "8x8", "--size", "8x8", "-o", "-"});
  REQUIRE(run.status == 0);
  CHECK(!contains(run.out, "face +x"));
  CHECK(contains(run.err, "face +x"));
  const std::string nowhere = folder.file("none/t_%d.png");
  check_refused(folder, {"relief", "turn", "figures", "-o", nowhere}, 1, {"t_0.png"});
  check_refused(folder, {"relief", "box", "figures", "-o", nowhere}, 1, {"t_0.png"});
  check_refused(folder, {"relief", "turn", "figures", "--box", "--texels-per-pixel", "2"}, 2,
                {"--texels-per-pixel", "--texels "});
}

TEST_CASE("relief: an eye straight above the object's middle has no side that is up") {
  const TemporaryDirectory folder;
  const auto scene_seen_from = [&](const char* name, const char* place) {
    std::string file = folder.file(name);
    write_file(file, std::string{"[camera]\nposition = "} + place +
                         "\ntarget = [3, 0, 0]\n[lens]\nfocal_length_mm = 50\nf_number = 2\n"
                         "focus_m = 3\n[material.m]\ndiffuse = [0.8, 0.2, 0.2]\n[[object]]\n"
                         "shape = \"cube\"\nmaterial = \"m\"\n");
    return file;
  };
  const std::string above = scene_seen_from("above.toml", "[0, 5, 0]");
  const std::string to = folder.file("a.relief");
  check_refused(folder, {"relief", "make", above, "-o", to}, 2, {"--pitch", "above"});
  CHECK(
      run_program({"relief", "make", above, "--pitch", "20", "--texels", "8x8", "-o", to}).status ==
      0);
  check_refused(folder, {"relief", "make", scene_seen_from("in.toml", "[0, 0, 0]"), "-o", to}, 2,
                {"'in'", "middle"});
}

TEST_CASE("relief: a box of six faces is shown, measured and written") {
  const TemporaryDirectory folder;
  const Words words{"relief", "box", "figures", "--texels", "40x40",
                    "--yaw",  "20",  "--size",  "48x40"};
  for (const char* part : {"image", "faces", "unseen"}) {
    Words own = words;
    const std::string picture = folder.file(std::string{part} + ".npy");
    own.insert(own.end(), {"--show", part, "-o", picture});
    const ProgramRun run = run_program(own);
    CHECK(run.err == "");
    REQUIRE(run.status == 0);
    CHECK(contains(run.out, "; seen"));
    CHECK(contains(run.out, "no face has"));
    CHECK(read_image_file(picture).image.width == 48);
  }
  Words faces = words;
  faces.insert(faces.end(), {"-o", folder.file("f_%d.relief")});
  REQUIRE(run_program(faces).status == 0);
  CHECK(run_program({"relief", "show", folder.file("f_4.relief"), "-o", folder.file("f.png")})
            .status == 0);
  check_refused(folder, {"relief", "box", "figures", "--show", "depth", "-o", folder.file("a.png")},
                2, {"--show", "faces"});
  check_refused(folder, {"relief", "box", "figures"}, 2, {"-o"});
  check_refused(folder, {"relief", "turn", "figures", "--texels", "64x64"}, 2,
                {"--texels", "--box"});
  const ProgramRun turn =
      run_program({"relief", "turn", "figures", "--box", "--texels", "40x40", "--frames", "4",
                   "--every", "4", "--size", "48x48", "--zoom", "0.2"});
  CHECK(turn.err == "");
  CHECK(contains(turn.out, "no face has"));
  const std::string sliced = folder.file("sliced.npy"), warped = folder.file("image.npy");
  Words by_slices = words;
  by_slices.insert(by_slices.end(), {"--slices", "32", "--bisections", "4", "-o", sliced});
  REQUIRE(run_program(by_slices).status == 0);
  CHECK(read_image_file(sliced).image.bytes != read_image_file(warped).image.bytes);
  check_refused(folder, {"relief", "turn", "figures", "--slices", "8"}, 2, {"--slices", "--box"});
  check_refused(folder, {"relief", "turn", "figures", "--box", "--bisections", "2"}, 2,
                {"--bisections", "--slices"});
  check_refused(folder, {"relief", "turn", "figures", "--box", "--slices", "9", "--join", "3"}, 2,
                {"--join", "--slices"});
}

TEST_CASE("relief turn: pixels are lit with a moving light alone, and renewals are traced") {
  const TemporaryDirectory folder;
  const Words turn{"relief", "turn",    "figures", "--zoom", "0.2",  "--frames",
                   "8",      "--every", "8",       "--size", "48x48"};
  const auto with = [&](const Words& more) {
    Words words = turn;
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  check_refused(folder, with({"--light-pixels"}), 2, {"--light-pixels", "--moving-light"});
  check_refused(folder, with({"--box", "--traced"}), 2, {"--traced", "six faces"});
  CHECK(run_program(with({"--moving-light", "--light-pixels"})).status == 0);
  const ProgramRun traced = run_program(with({"--traced"}));
  if (traced_relief_missing().empty()) {
    CHECK(traced.status == 0);
    CHECK(contains(traced.out, "renewals "));
  } else {
    CHECK(traced.status == 2);
  }
}

TEST_CASE("relief turn: an octahedral atlas goes the same turn, and says what it takes") {
  const TemporaryDirectory folder;
  const ProgramRun turn =
      run_program({"relief", "turn", "figures", "--rival", "octahedral", "--views", "3", "--frames",
                   "6", "--every", "3", "--size", "64x64", "-o", folder.file("t_%02d.npy")});
  CHECK(turn.err == "");
  REQUIRE(turn.status == 0);
  CHECK(contains(turn.out, "octahedral atlas: views 3x3, of sphere, texels "));
  CHECK(contains(turn.out, ", megabytes "));
  CHECK(contains(turn.out, "errors: flip "));
  const Image pair = read_image_file(folder.file("t_03.npy")).image;
  CHECK(pair.width == 128);
  check_refused(folder, {"relief", "turn", "figures", "--rival", "cube"}, 2,
                {"--rival", "octahedral"});
  check_refused(folder, {"relief", "turn", "figures", "--views", "1"}, 2, {"--views", "2 to 64"});
  check_refused(folder, {"relief", "make", "figures", "--parallax", "1"}, 2, {"--parallax"});
  check_refused(folder, {"relief", "turn", "figures", "--parallax", "1"}, 2,
                {"--parallax", "--rival"});
  check_refused(folder, {"relief", "turn", "figures", "--rival", "octahedral", "--tolerance", "4"},
                2, {"--tolerance", "atlas"});
}

TEST_CASE("relief: wrong words and bad files get one line") {
  const TemporaryDirectory folder;
  const std::string relief = relief_by(folder);
  const std::string picture = folder.file("a.png");
  const std::string broken = folder.file("broken.relief");
  write_file(broken, std::string_view{read_file(relief)}.substr(0, 500));
  check_refused(folder, {"relief", "mend", "figures"}, 2, {"ACTION", "make"});
  check_refused(folder, {"relief", "make", "figures"}, 2, {"-o is missing"});
  check_refused(folder, {"relief", "make", "figures", "--texels", "2x9", "-o", picture}, 2,
                {"--texels", "4 to 4096"});
  check_refused(folder, {"relief", "make", "figures", "--depth-bits", "12", "-o", picture}, 2,
                {"--depth-bits", "there are 8, 16"});
  check_refused(folder, {"relief", "make", "figures", "--projection", "fisheye", "-o", picture}, 2,
                {"--projection", "perspective"});
  check_refused(folder,
                {"relief", "make", "cube-room", "--projection", "perspective", "-o", picture}, 2,
                {"--projection perspective", "beside the eye"});
  check_refused(folder, {"relief", "show", relief, "--runs", "3", "-o", picture}, 2,
                {"--runs", "show does not read it"});
  check_refused(folder, {"relief", "show", relief, "--show", "normals", "-o", picture}, 2,
                {"--show normals", "has none"});
  check_refused(folder, {"relief", "warp", relief, "--yaw", "120", "-o", picture}, 2,
                {"--yaw", "front"});
  check_refused(folder, {"relief", "warp", broken, "-o", picture}, 1, {"broken.relief", "bytes"});
  check_refused(folder, {"relief", "warp", "nowhere.relief", "-o", picture}, 1, {"nowhere.relief"});
  check_refused(folder, {"relief", "turn", "figures", "-o", picture}, 2, {"-o", "%04d"});
  check_refused(folder, {"relief", "show", relief, "-o", relief + ".png", "--format", "xyz"}, 2,
                {"--format"});
}

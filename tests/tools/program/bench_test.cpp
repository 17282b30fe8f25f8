// bench from end to end. They check that times are there, not what they are.

#include <doctest/doctest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "raster/lanes/isa.h"
#include "tests/support/cli_refused.h"
#include "tests/support/gl_drivers.h"
#include "tools/gl/driver/driver.h"

using namespace softfocus;

namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

const Words kSpheres{"--triangles", "1500", "--size", "64x64"};
const Words kScene{"figures", "--size", "64x64"};
const Words kPicture{"--image", "64x64"};

// Ten runs at a small size, as JSON.
json benched(const Words& subject, const Words& more = {}) {
  Words words{"bench", "--runs", "10", "--json"};
  words.insert(words.end(), subject.begin(), subject.end());
  words.insert(words.end(), more.begin(), more.end());
  const ProgramRun run = run_program(words);
  CHECK(run.status == 0);
  CHECK(run.err == "");
  return json::parse(run.out);
}

std::string profile_of(const std::string& driver) {
  return std::string{find_driver(driver)->profile};
}

void check_stages(const json& stages, const Words& names) {
  Words found;
  for (const json& stage : stages) {
    found.push_back(stage.at("name"));
    CHECK(stage.at("min_ms") > 0.0);
    CHECK(stage.at("min_ms") <= stage.at("median_ms"));
    CHECK(stage.at("median_ms") <= stage.at("max_ms"));
  }
  CHECK(found == names);
}

const Words kAllStages{"raster", "dof", "frame"};

// The faster of a shader's two forms is the peer.
void check_faster_form(const json& result, bool filters) {
  const json& shaders = result["peer"]["shaders"];
  CHECK(shaders.size() == (filters ? 2 : 0));
  CHECK(result["peer"]["shader"].is_null() == !filters);
  if (!filters) return;
  CHECK(shaders[0]["name"] == "brute-force");
  CHECK(shaders[1]["name"] == "tiled");
  const double brute_force_ms = shaders[0]["dof_median_ms"], tiled_ms = shaders[1]["dof_median_ms"];
  CHECK(result["peer"]["shader"] == (tiled_ms < brute_force_ms ? "tiled" : "brute-force"));
  for (const json& stage : result["peer"]["stages"]) {
    if (stage["name"] != "dof") continue;
    CHECK(stage["median_ms"] == std::min(brute_force_ms, tiled_ms));
  }
}

void check_versus(const std::string& driver, const Words& scene, const Words& methods) {
  if (!has_driver(driver)) return;
  for (const std::string& method : methods) {
    CAPTURE(method);
    const json result = benched(scene, {"--vs", driver, "--profile", profile_of(driver), "--method",
                                        method, "--max-coc", "4"});
    CHECK(result["peer"]["driver"] == driver);
    CHECK(result["peer"]["renderer"].get<std::string>().starts_with(
        std::string{find_driver(driver)->gallium_driver}));
    check_stages(result["stages"], kAllStages);
    check_stages(result["peer"]["stages"], kAllStages);
    for (const std::string& stage : kAllStages) {
      CHECK(result["ratio_min"][stage] > 0.0);
      CHECK(result["ratio_min"][stage] <= result["ratio"][stage]);
      CHECK(result["ratio"][stage] <= result["ratio_max"][stage]);
    }
    CHECK(result["equal"] == true);
    CHECK(result["difference"].is_null());
    check_faster_form(result, method != "pinhole");
  }
}

}  // namespace

TEST_CASE("bench: --json tells what was measured and three stages") {
  const json result = benched(kSpheres, {"--max-coc", "3", "--threads", "2", "--isa", "scalar"});
  CHECK(result["scene"] == "spheres");
  CHECK(result["triangles"] == 1500);
  CHECK(result["size"] == "64x64");
  CHECK(result["method"] == "two-pass");
  CHECK(result["max_coc"] == 3.0);
  CHECK(result["profile"] == "ieee");
  CHECK(result["threads"] == 2);
  CHECK(result["isa"] == "scalar");
  CHECK(result["runs"] == 10);
  CHECK(result["softfocus"].is_string());
  CHECK(result["compiler"].is_string());
  CHECK(result.contains("cpu"));
  check_stages(result["stages"], kAllStages);
}

TEST_CASE("bench: without --vs there is no peer, no ratio and nothing to be equal to") {
  const json result = benched(kScene);
  for (const char* key : {"peer", "ratio", "ratio_min", "ratio_max", "equal"}) {
    CAPTURE(key);
    CHECK(result.at(key).is_null());
  }
  check_stages(result["stages"], {"raster", "dof", "frame", "command"});
}

TEST_CASE("bench: a scene is measured at its own filter size, or as --max-coc says") {
  CHECK(benched(kScene)["scene"] == "figures");
  CHECK(benched(kScene)["max_coc"] == 1.0);  // 16 at 1024 rows
  CHECK(benched(kScene, {"--max-coc", "5.5"})["max_coc"] == 5.5);
}

TEST_CASE("bench: a scene's file, another frame and another lens can be measured") {
  const TemporaryDirectory directory;
  write_file(directory.file("mine.toml"),
             "[material.m]\n[[object]]\nshape = \"cube\"\ncells = 1\nmaterial = \"m\"\n");
  const json result = benched({directory.file("mine.toml"), "--size", "64x64"},
                              {"--frame", "7", "--focus", "1.5", "--f-number", "2",
                               "--focal-length", "35", "--coc-scale", "0"});
  CHECK(result["scene"] == "mine");
  CHECK(result["triangles"] == 12);
  CHECK(benched({"mine", "--size", "64x64"}, {"--scene-path", directory.path()})["triangles"] ==
        12);
}

TEST_CASE("bench: --frames times each frame of the animation, and says what 99 of 100 keep to") {
  const json frames = benched(kScene, {"--frames", "0..30:2"})["frames"];
  CHECK(frames["count"] == 16);
  CHECK(frames["min_ms"] > 0.0);
  CHECK(frames["min_ms"] <= frames["median_ms"]);
  CHECK(frames["median_ms"] <= frames["percentile_99_ms"]);
  CHECK(frames["percentile_99_ms"] == frames["max_ms"]);  // 15 of 16 are not 99 of 100
  CHECK(frames["within_a_60th"] <= 16);
  CHECK(benched(kScene)["frames"].is_null());
  const ProgramRun run =
      run_program({"bench", "figures", "--size", "32x32", "--runs", "10", "--frames", "7"});
  CHECK(contains(run.out, "\n1 frame "));
  CHECK(contains(run.out, " ms, 99 of 100 within "));
  CHECK(contains(run.out, " within a 60th of a second\n"));
}

TEST_CASE("bench: of a picture only the filter is timed, and there are no triangles") {
  const json result = benched(kPicture);
  CHECK(result["scene"] == "picture");
  CHECK(result["size"] == "64x64");
  CHECK(result["triangles"].is_null());
  check_stages(result["stages"], {"dof"});
}

TEST_CASE("bench: the text is a heading and a line for each stage") {
  const ProgramRun run =
      run_program({"bench", "figures", "--size", "64x64", "--runs", "10", "--threads", "1"});
  CHECK(run.status == 0);
  CHECK(run.err == "");
  CHECK(run.out.starts_with("figures, "));
  for (const char* part : {" triangles, 64x64, two-pass, max-coc 1\n", "profile ieee, 1 thread, ",
                           ", 10 runs, ", "\nraster  ", "\ndof     ", "\nframe   "}) {
    CAPTURE(part);
    CHECK(contains(run.out, part));
  }
  CHECK_FALSE(contains(run.out, "against"));
  CHECK_FALSE(contains(run.out, " \n"));
}

TEST_CASE("bench: --vs llvmpipe times both, whose pictures are equal in its profile" *
          doctest::test_suite("long")) {
  check_versus("llvmpipe", kScene, {"two-pass", "one-pass", "pinhole"});
}
TEST_CASE("bench: --vs softpipe times both, whose pictures are equal in its profile" *
          doctest::test_suite("long")) {
  // The driver is slow.
  check_versus("softpipe", {"figures", "--size", "16x12"}, {"two-pass"});
}

TEST_CASE("bench: --vs lavapipe times both, whose pictures are equal in its profile" *
          doctest::test_suite("long")) {
  check_versus("lavapipe", kScene, {"two-pass"});
}

TEST_CASE("bench: --vs of a picture compares the filter alone") {
  if (!has_driver("llvmpipe")) return;
  for (const char* method : {"two-pass", "one-pass", "pinhole"}) {
    CAPTURE(method);
    const json result = benched(kPicture, {"--vs", "llvmpipe", "--profile", profile_of("llvmpipe"),
                                           "--method", method, "--threads", "1", "--max-coc", "6"});
    CHECK(result["ratio"]["raster"].is_null());
    CHECK(result["ratio"]["frame"].is_null());
    CHECK(result["ratio"]["dof"] > 0.0);
    check_stages(result["peer"]["stages"], {"dof"});
    CHECK(result["equal"] == true);
    check_faster_form(result, method != std::string{"pinhole"});
  }
}

TEST_CASE("bench: pictures that differ are said to, and which profile would make them equal") {
  if (!has_driver("llvmpipe")) return;
  const json result = benched(kSpheres, {"--vs", "llvmpipe", "--profile", "ieee"});
  CHECK(result["equal"] == false);
  const std::string profile = profile_of("llvmpipe");
  CHECK(result["difference"] == "llvmpipe rounds as profile " + profile +
                                    ", not as ieee; --profile " + profile + " gives its bits");
}

TEST_CASE("bench: auto is timed with its choice, which is told") {
  const json sharp = benched(kScene, {"--method", "auto", "--coc-scale", "0"});
  CHECK(sharp["method"] == "auto");
  CHECK(sharp["chosen"] == "pinhole");
  CHECK(sharp["max_coc"].is_null());
  check_stages(sharp["stages"], kAllStages);
  const ProgramRun run = run_program({"bench", "figures", "--size", "64x64", "--runs", "10",
                                      "--method", "auto", "--max-time", "0"});
  CHECK(run.status == 0);
  CHECK(contains(run.out, ", 64x64, auto: "));
}

TEST_CASE("bench: methods that draw the scene are timed, and their samples are told") {
  const json result = benched(kScene, {"--method", "accumulation", "--samples", "3"});
  CHECK(result["method"] == "accumulation");
  CHECK(result["samples"] == 3);
  CHECK(result["max_coc"].is_null());
  CHECK(result["chosen"].is_null());
  check_stages(result["stages"], kAllStages);
  CHECK(benched(kScene, {"--method", "accumulation", "--until", "1000"})["samples"] == 16);
}

TEST_CASE("bench: the text of a comparison names the driver and says whether the bits agree") {
  if (!has_driver("llvmpipe")) return;
  const ProgramRun run = run_program({"bench", "figures", "--size", "64x64", "--runs", "10", "--vs",
                                      "llvmpipe", "--profile", profile_of("llvmpipe")});
  CHECK(run.status == 0);
  CHECK(contains(run.out, "\nagainst llvmpipe ("));
  CHECK(contains(run.out, ": the pictures are equal to the bit\n"));
  CHECK(contains(run.out, "llvmpipe / ours"));
  CHECK(contains(run.out, "\nllvmpipe with the faster shader, "));
  CHECK(contains(run.out, ": brute-force "));
  CHECK(contains(run.out, " ms, tiled "));
}

TEST_CASE("bench: effects are timed one by one, on a scene or a picture") {
  const Words two{"--effect", "bloom:levels=3,spread=0.6", "--effect", "sharpen"};
  for (const Words& subject : {kScene, kPicture}) {
    const json result = benched(subject, two);
    REQUIRE(result["effects"].size() == 2);
    CHECK(result["effects"][0]["effect"] == "bloom:levels=3");
    CHECK(result["effects"][1]["effect"] == "sharpen");
    for (const json& effect : result["effects"]) {
      CHECK(effect["ms"]["min"] > 0.0);
      CHECK(effect["ms"]["median"] <= effect["ms"]["max"]);
      CHECK(effect["equal"].is_null());
    }
    CHECK(result["peer"].is_null());
  }
}

TEST_CASE("bench: --vs llvmpipe runs every effect's shaders, whose bits are ours" *
          doctest::test_suite("long")) {
  if (!has_driver("llvmpipe")) return;
  // Their bits on more and larger pictures: crosscheck.
  const json result =
      benched({"crossing", "--size", "24x16", "--frame", "7"},
              {"--effect", "all", "--vs", "llvmpipe", "--profile", profile_of("llvmpipe")});
  for (const json& effect : result["effects"]) {
    CAPTURE(effect["effect"].get<std::string>());
    CHECK(effect["equal"] == true);
    CHECK(effect["ratio"]["median"] > 0.0);
    CHECK(effect["quad_over_triangle"]["median"] > 0.0);
  }
  // Effects that read a velocity or the frames before need a scene.
  const json of_picture = benched({"--image", "24x16"}, {"--effect", "all"});
  CHECK(of_picture["effects"].size() >= 13);
  CHECK(result["effects"].size() == of_picture["effects"].size() + 4 + 3);
}

TEST_CASE(
    "bench: an effect of frames is timed after a history, of a scene that moves or is still") {
  for (const Words& subject : {Words{"crossing", "--size", "64x64", "--frame", "7"}, kSpheres}) {
    const json result = benched(subject, {"--effect", "temporal-aa:places=16", "--effect",
                                          "refresh:warm-up=3", "--effect", "reproject:every=7"});
    REQUIRE(result["effects"].size() == 3);
    CHECK(result["effects"][0]["effect"] == "temporal-aa:places=16");
    CHECK(result["effects"][1]["effect"] == "refresh:warm-up=3");
    for (const json& effect : result["effects"]) CHECK(effect["ms"]["min"] > 0.0);
  }
}

TEST_CASE("bench: --vs llvmpipe has our bits of frames by each way to make them") {
  if (!has_driver("llvmpipe")) return;
  Words more{"--vs", "llvmpipe", "--profile", profile_of("llvmpipe")};
  for (const char* effect :
       {"temporal-aa:box=0", "temporal-aa:box=1,cubic=0", "refresh:groups=16", "reproject:holes=1",
        "reproject:holes=2", "reproject:forward=1", "reproject:forward=1,holes=1,every=3",
        "reproject:forward=1,holes=2"}) {
    more.insert(more.end(), {"--effect", effect});
  }
  const json result = benched({"crossing", "--size", "61x43", "--frame", "7"}, more);
  REQUIRE(result["effects"].size() == 8);
  for (const json& effect : result["effects"]) {
    CAPTURE(effect["effect"].get<std::string>());
    CHECK(effect["equal"] == true);
    CHECK(effect["ratio"]["median"] > 0.0);
  }
}

TEST_CASE("bench: --copy times a frame whose pictures are copied, here and on a driver" *
          doctest::test_suite("long")) {
  const ProgramRun run =
      run_program({"bench", "figures", "--size", "64x64", "--runs", "10", "--copy"});
  CHECK(run.status == 0);
  CHECK(contains(run.out, "\ncopied  "));
  CHECK(contains(run.out, "\nours: "));
  CHECK(contains(run.out, " frames a second rendering to textures, "));
  if (!has_driver("llvmpipe")) return;
  for (const char* method : {"two-pass", "one-pass"}) {
    const json result =
        benched(kScene, {"--copy", "--vs", "llvmpipe", "--profile", profile_of("llvmpipe"),
                         "--method", method, "--max-coc", "4"});
    check_stages(result["stages"], {"raster", "dof", "frame", "copied"});
    check_stages(result["peer"]["stages"], {"raster", "dof", "frame", "copied"});
    CHECK(result["ratio"]["copied"] > 0.0);
    CHECK(result["equal"] == true);
  }
}

TEST_CASE("bench: a driver that is not there is told in one line, with status 2") {
  if (!has_driver("llvmpipe")) return;
  const EnvironmentVariable none{"__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent.json"};
  const ProgramRun run = run_program({"bench", "--image", "64x64", "--vs", "llvmpipe"});
  CHECK(run.status == 2);
  CHECK(run.out == "");
  CHECK(is_one_line(run.err));
  CHECK(contains(run.err, "driver llvmpipe: "));
}

TEST_CASE("bench: exactly one thing to measure must be given, and all three are named") {
  const TemporaryDirectory directory;
  const Words choices{"SCENE", "--triangles N", "--image WxH"};
  check_refused(directory, {"bench"}, 2, choices);
  check_refused(directory, {"bench", "figures", "--triangles", "64000"}, 2, choices);
  check_refused(directory, {"bench", "figures", "--image", "64x64"}, 2, choices);
  check_refused(directory, {"bench", "--triangles", "64000", "--image", "64x64"}, 2, choices);
}

TEST_CASE("bench: bad options are refused with what would be right") {
  const TemporaryDirectory directory;
  const auto refused = [&](const Words& more, const Words& named, int status = 2) {
    Words words{"bench"};
    words.insert(words.end(), more.begin(), more.end());
    check_refused(directory, words, status, named);
  };
  refused({"--triangles", "1499"}, {"--triangles '1499'", "1500 to 8000000"});
  refused({"--triangles", "many"}, {"--triangles 'many'"});
  refused({"--triangles", "8000001"}, {"--triangles"});
  refused({"--image", "0x64"}, {"--image '0x64'"});
  refused({"--image", "64x64", "--size", "64x64"}, {"--image and --size"});
  refused({"figures", "--isa", "abacus"}, {"--isa 'abacus'", "this CPU has scalar, "});
  refused({"figures", "--runs", "9"}, {"--runs '9'", "10 to 1000"});
  refused({"figures", "--threads", "0"}, {"--threads '0'"});
  refused({"figures", "--method", "three-pass"}, {"--method", "two-pass"});
  refused({"figures", "--max-coc", "2000"}, {"--max-coc"});
  refused({"figures", "--vs", "voodoo"}, {"--vs 'voodoo'", "llvmpipe, llvmpipe-sse41, softpipe"});
  refused({"figures", "--focal-length", "3000"}, {"--focal-length 3000 mm"});
  refused(
      {"figures", "--vs", "llvmpipe", "--method", "disc-layers"},
      {"--vs and --method disc-layers", "two-pass, one-pass and pipelines", "--method pinhole"});
  refused({"figures", "--vs", "llvmpipe", "--method", "auto"}, {"--vs and --method auto"});
  refused({"--image", "64x64", "--method", "auto"}, {"--image and --method auto", "SCENE"});
  refused({"--image", "64x64", "--method", "accumulation"}, {"--image and --method accumulation"});
  refused({"figures", "--samples", "4"}, {"--samples", "two-pass", "accumulation"});
  refused({"figures", "--method", "auto", "--samples", "4"}, {"--samples", "auto"});
  refused({"figures", "--max-error", "0.1"}, {"--max-error", "--method auto"});
  refused({"--image", "64x64", "--effect", "motion-blur"},
          {"--image and --effect motion-blur", "velocity", "SCENE"});
  refused({"--image", "64x64", "--effect", "temporal-aa"},
          {"--image and --effect temporal-aa", "frames before", "SCENE"});
  refused({"figures", "--effect", "reproject:every=1"}, {"reproject:every=1", "2 or more"});
  refused({"figures", "--effect", "blur"}, {"--effect 'blur'", "gaussian"});
  refused({"figures", "--effect", "bloom", "--method", "two-pass"}, {"--effect and --method"});
  refused({"figures", "--effect", "bloom", "--max-coc", "4"}, {"--effect and --max-coc"});
  refused({"figures", "--effect", "bloom", "--copy"}, {"--copy needs"});
  refused({"--image", "64x64", "--copy"}, {"--copy needs", "SCENE"});
  refused({"figures", "--method", "accumulation", "--copy"}, {"--copy needs"});
  refused({"--triangles", "1500", "--frames", "0..9"}, {"--frames needs a SCENE", "--triangles"});
  refused({"figures", "--frames", "9..0"}, {"--frames '9..0'"});
  refused({"figures", "cube-room"}, {"unexpected argument 'cube-room'"});
  refused({"no-such-scene"}, {"no-such-scene"}, 1);
}

TEST_CASE("bench: the help names every option") {
  const ProgramRun run = run_program({"bench", "--help"});
  CHECK(run.status == 0);
  for (const char* option : {"SCENE",
                             "--triangles N",
                             "--image WxH",
                             "--size WxH",
                             "--frame N",
                             "--scene-path DIR",
                             "--method NAME",
                             "--focus METRES",
                             "--focal-length MM",
                             "--f-number N",
                             "--coc-scale S",
                             "--max-coc PIXELS",
                             "--samples N",
                             "--jitter",
                             "--until ERROR",
                             "--aperture-blades N",
                             "--max-error E",
                             "--max-time MS",
                             "--profile NAME",
                             "--threads N",
                             "--isa NAME",
                             "--runs N",
                             "--vs DRIVER",
                             "--effect NAME:KEY=VALUE,...",
                             "--copy",
                             "--json"}) {
    CAPTURE(option);
    CHECK(contains(run.out, std::string{"  "} + option));
  }
}

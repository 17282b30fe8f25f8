// softfocus shadows, and render --shadows, from end to end.

#include <doctest/doctest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/cli_refused.h"
#include "tests/support/gl_drivers.h"
#include "tests/support/shadow_scene.h"
#include "tools/cli/errors.h"
#include "tools/options/scene_options.h"
#include "tools/pictures/image_file.h"

using namespace softfocus;

namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

json measured(const Words& more) {
  Words words{"shadows", "--size", "64x48", "--runs", "1", "--json"};
  words.insert(words.end(), more.begin(), more.end());
  const ProgramRun run = run_program(words);
  CHECK(run.status == 0);
  CHECK(run.err == "");
  return json::parse(run.out);
}

void check_none_wrong(const json& found, int seen) {
  const json& check = found.at("check");
  CHECK(check.at("seen") == seen);
  CHECK(check.at("in_shadow") > 0);
  CHECK(check.at("wrong") == 0);
}

std::uint64_t drawn(const TemporaryDirectory& folder, const Words& more) {
  const std::string file = folder.file("a.npy");
  Words words{"render", "--size", "64x48", "--show", "pinhole", "-o", file};
  words.insert(words.end(), more.begin(), more.end());
  const ProgramRun run = run_program(words);
  CHECK(run.err == "");
  REQUIRE(run.status == 0);
  return hash_image(read_image_file(file).image);
}

}  // namespace

TEST_CASE("shadows --check: no pixel of projected shadows and of volumes is wrong") {
  for (const Words& kind : {Words{"--shadows", "projected"}, Words{"--shadows", "volumes"},
                            Words{"--shadows", "volumes", "--z-pass"}}) {
    CAPTURE(kind.back());
    Words words = kind;
    words.insert(words.end(), {"cube-room", "--check"});
    const json found = measured(words);
    check_none_wrong(found, 6144);
    CHECK(found.at("scene") == "cube-room");
    CHECK(found.at("times").back().at("name") == "frame without shadows");
    CHECK(found.at("times").back().at("median_ms") > 0.0);
  }
}

TEST_CASE("shadows --check: a map without a bias shades itself, and says so") {
  const Words map{"cube-room", "--shadows", "map", "--check"};
  CHECK(measured(map).at("check").at("acne") == 0);
  Words biased = map;
  biased.insert(biased.end(), {"--map", "bias=0,slope-bias=0"});
  CHECK(measured(biased).at("check").at("acne") > 0);
}

TEST_CASE("shadows --soft --check: no pixel of a light's points is wrong") {
  check_none_wrong(measured({"cube-room", "--soft", "2", "--light-radius", ".3", "--light-angle",
                             "2", "--check"}),
                   12288);
}

TEST_CASE("shadows --vs: a driver draws the same stencil") {
  if (!has_driver("llvmpipe")) return;
  const json ratio = measured({"cube-room", "--vs", "llvmpipe"}).at("ratio");
  CHECK(ratio.at("differ") == 0);
  CHECK(ratio.at("pixels") == 3072);
  CHECK(ratio.at("renderer").get<std::string>().starts_with("llvmpipe"));
}

TEST_CASE("shadows --vs: a driver draws the same maps") {
  if (!has_driver("llvmpipe")) return;
  const json ratio =
      measured({"near-fence", "--shadows", "map", "--map", "size=64", "--vs", "llvmpipe"})
          .at("ratio");
  CHECK(ratio.at("differ") == 0);
  CHECK(ratio.at("texels") > 0);
  CHECK(ratio.at("renderer").get<std::string>().starts_with("llvmpipe"));
}

TEST_CASE("shadows: what it says without --json has the same names") {
  const ProgramRun run =
      run_program({"shadows", "cube-room", "--size", "64x48", "--runs", "1", "--check"});
  CHECK(run.status == 0);
  CHECK(run.out.starts_with("scene cube-room, triangles "));
  CHECK(run.out.find("\ncheck: seen 6144, in shadow ") != std::string::npos);
  CHECK(run.out.find(", wrong 0\n") != std::string::npos);
}

TEST_CASE("shadows --map-table: each setting has a row, and sweeps have their numbers") {
  const json found = measured({"cube-room", "--shadows", "map", "--map", "size=64", "--map-table"});
  CHECK(found.at("settings").size() == 33);
  const json& first = found.at("settings")[0];
  CHECK(first.at("name") == "size=256");
  CHECK(first.at("setting") == "size");
  CHECK(first.at("value") == 256);
  for (const char* key : {"ms", "wrong", "aliasing", "acne", "peter_panning", "near_edge",
                          "missed_shares", "projected_ms"}) {
    CAPTURE(key);
    CHECK(first.at(key).is_number());
  }
}

TEST_CASE("shadows --terminator-table: each shape, detail and rule has a row") {
  const json curves = measured({"--terminator-table"}).at("terminators");
  CHECK(curves.size() == 36);
  CHECK(curves[0].at("shape") == "sphere");
  for (const char* key : {"flip", "flip_band", "flip_shape", "flip_floor", "band_pixels"}) {
    CHECK(curves[0].at(key).is_number());
  }
}

TEST_CASE("render --shadows overrules a scene file's lights, and none is the scene without") {
  const TemporaryDirectory folder;
  const std::string plain = folder.file("plain.toml"), shadowed = folder.file("shadowed.toml");
  const std::string text = R"(
[camera]
position = [0, 3, 5]
target = [0, 0, 0]
fov_degrees = 50
[material.grey]
diffuse = [0.6, 0.6, 0.6]
[[object]]
shape = "plane"
width = 8
depth = 8
material = "grey"
[[object]]
shape = "cube"
position = [0, 1.5, 0]
material = "grey"
[[light]]
kind = "point"
position = [1, 6, 1]
)";
  std::ofstream{plain} << text;
  std::ofstream{shadowed} << text << "shadows = \"volumes\"\n";
  const std::uint64_t none = drawn(folder, {plain});
  const std::uint64_t projected = drawn(folder, {plain, "--shadows", "projected"});
  CHECK(projected != none);
  CHECK(drawn(folder, {shadowed}) == projected);
  CHECK(drawn(folder, {shadowed, "--shadows", "none"}) == none);
  CHECK(drawn(folder, {plain, "--shadows", "map", "--map", "size=4096"}) != none);

  const std::string whole = folder.file("whole.toml");
  std::ofstream{whole} << "light_points = 5\n"
                       << text
                       << "shadows = \"projected\"\nradius_m = 0.25\nshadow_darkness = 0.5\n"
                          "terminators = \"normals\"\n";
  CHECK(drawn(folder, {plain, "--shadows", "projected", "--light-radius", ".25", "--soft", "5",
                       "--shadow-darkness", ".5", "--soften-terminators", "normals"}) ==
        drawn(folder, {whole}));
  CHECK(drawn(folder, {plain, "--shadows", "projected", "--shadow-darkness", "1"}) == projected);
  CHECK(drawn(folder, {plain, "--shadows", "projected", "--shadow-darkness", "0"}) == none);
  CHECK(drawn(folder, {whole, "--light-radius", "0", "--shadow-darkness", "1"}) == projected);
}

TEST_CASE("shadows and render --shadows: what does not go together is one clear line") {
  const TemporaryDirectory folder;
  const auto refused = [&](const Words& words, const Words& said) {
    check_refused(folder, words, 2, said);
  };
  refused({"shadows"}, {"SCENE", "--triangles"});
  refused({"shadows", "figures", "--z-pass"}, {"--z-pass", "--shadows volumes"});
  refused({"shadows", "figures", "--shadows", "volumes", "--vs", "llvmpipe"},
          {"--vs", "--shadows projected"});
  refused({"shadows", "figures", "--shadows", "map", "--map-table", "--vs", "llvmpipe"},
          {"--vs", "--map-table"});
  refused({"shadows", "figures", "--map-table"}, {"--map-table", "--shadows map"});
  refused({"shadows", "figures", "--shadows", "fog"}, {"'fog'", "projected, volumes, map"});
  refused({"shadows", "figures", "--terminator-table"}, {"--terminator-table", "SCENE"});
  if (run_program(
          {"shadows", "--triangles", "1500", "--size", "8x8", "--runs", "1", "--check-embree"})
          .status == 0) {
    refused({"shadows", "figures", "--shadows", "map", "--check-embree"},
            {"--check-embree", "projected"});
  }
  refused({"shadows", "figures", "--soft-table"}, {"--soft-table", "--light-angle"});
  refused({"shadows", "figures", "--soft", "5000"}, {"'5000'", "1 to 4096"});
  refused({"shadows", "cube-room", "--light-radius", ".2", "--vs", "llvmpipe"},
          {"--vs", "--light-radius 0"});
  refused({"render", "figures", "-o", "a.png", "--soft", "4"}, {"--soft", "--shadows"});
  refused({"render", "figures", "-o", "a.png", "--shadows", "projected", "--soft", "4"},
          {"--soft", "--light-radius"});
  refused({"render", "figures", "-o", "a.png", "--shadows", "projected", "--shadow-darkness", "2"},
          {"'2'", "0 to 1"});
  refused({"render", "figures", "-o", "a.png", "--soften-terminators", "soft"},
          {"'soft'", "facets, normals, fade"});
  refused({"render", "figures", "-o", "a.png", "--shadows", "maps"}, {"'maps'", "'map'"});
  refused({"render", "figures", "-o", "a.png", "--map", "size=64"}, {"--map", "--shadows map"});
  refused({"render", "figures", "-o", "a.png", "--shadows", "map", "--map", "size=1"},
          {"'1'", "16 to 8192"});
  refused({"render", "figures", "-o", "a.png", "--shadows", "map", "--map", "siz=64"},
          {"'siz'", "did you mean 'size'?"});
  refused({"render", "figures", "-o", "a.png", "--shadows", "projected", "--method", "ray-traced"},
          {"ray-traced", "--shadows none"});
}

TEST_CASE("--light moves the first light and no other") {
  Scene scene = test::shadow_scene(ShadowKind::none);
  const glm::vec3 sun = scene.lights[1].position_or_direction;
  SceneLook look;
  look.light = glm::vec3{1.0f, 2.0f, 3.0f};
  set_look(look, scene);
  CHECK(scene.lights[0].position_or_direction == glm::vec3{1.0f, 2.0f, 3.0f});
  CHECK(scene.lights[1].position_or_direction == sun);
  scene.lights.clear();
  CHECK_THROWS_WITH_AS(set_look(look, scene), "--light: the scene has no light", UsageError);
}

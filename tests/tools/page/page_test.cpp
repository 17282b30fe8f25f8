// The page's requests, answered natively.

#include <doctest/doctest.h>

#include <iterator>
#include <sstream>

#include "dof/measure/flip.h"
#include "raster/images/texel.h"
#include "raster/shaders/glsl/glsl.h"
#include "scenes/lens_views/lens_points.h"
#include "scenes/load/load_scene.h"
#include "tests/support/gl_drivers.h"
#include "tests/support/run_program.h"
#include "tools/page/compiled_shader.h"
#include "tools/page/page.h"
#include "tools/stress/cases/stress_case.h"

using namespace softfocus;

namespace {

Json ask(Page& page, const std::string& request) {
  const std::optional<Json> reply = parse_json(answer(page, request));
  REQUIRE(reply);
  return *reply;
}

Json ask_well(Page& page, const std::string& request) {
  Json reply = ask(page, request);
  const Json* error = reply.find("error");
  CAPTURE(request);
  REQUIRE_MESSAGE(error == nullptr, error->text());
  return reply;
}

void open(Page& page, const std::string& scene) {
  ask_well(page, R"({"do":"open","scene":")" + scene + "\"}");
}

std::string hash_of(Page& page, const std::string& settings) {
  return ask_well(page, R"({"do":"frame",)" + settings + "}").at("hash").text();
}

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream words{line};
  return {std::istream_iterator<std::string>{words}, {}};
}

Image two_pass_picture(const Scene& scene, int width, int height) {
  ThreadPool pool(1);
  const CameraMatrices view = camera_matrices(scene.camera, 0.0, width, height);
  DofSettings settings;
  settings.coc =
      pixel_coc(scene.lens.lens, scene.camera.fov_y_degrees, height, scene.lens.coc_scale);
  settings.max_coc_px = static_cast<float>(scene.lens.max_coc_px_at_1024 * height / 1024.0);
  const Image sharp = draw_scene(scene, view, 0.0, width, height, Profile{}, pool);
  return apply(*find_method("two-pass"), {sharp, settings, Profile{}}, pool);
}

}  // namespace

TEST_CASE("a frame is the scene's picture, and the screen shows it in sRGB") {
  Page page;
  open(page, "figures");
  const Json reply = ask_well(page, R"({"do":"frame","size":[40,24]})");
  const Image expected = two_pass_picture(load_scene("figures", scene_search_path({})), 40, 24);
  CHECK(reply.at("hash").text() == hash_text(hash_image(expected)));
  REQUIRE(page.pixels.rgba.size() == 40 * 24 * 4);
  for (const int x : {0, 17, 39}) {
    const glm::vec4 texel = load_texel<Format::rgba16f>(expected, x, 23);
    const std::uint8_t* pixel = &page.pixels.rgba[static_cast<std::size_t>(23 * 40 + x) * 4];
    for (int c = 0; c < 3; ++c) CHECK(pixel[c] == linear_to_srgb8(texel[c]));
    CHECK(pixel[3] == 255);
  }
}

TEST_CASE("a frame is the same drawn anew, from the kept drawing and on more threads") {
  Page page;
  open(page, "cube-room");
  const std::string frame = R"("size":[64,64],"time":3,"f_number":1.2)";
  const std::string hash = hash_of(page, frame);
  hash_of(page, R"("size":[64,64],"time":3,"f_number":4)");
  CHECK(hash_of(page, frame) == hash);
  ask_well(page, R"({"do":"start","threads":3})");
  open(page, "cube-room");
  CHECK(hash_of(page, frame) == hash);
}

TEST_CASE("a frame of samples that comes in slices has the same bits, and ends in between") {
  for (const char* method : {"accumulation", "filtered-views"}) {
    CAPTURE(method);
    const std::string settings =
        R"("size":[48,32],"samples":40,"method":")" + std::string{method} + '"';
    Page page;
    open(page, "figures");
    const std::string whole = hash_of(page, settings);
    const std::string request = R"({"do":"frame","slice_ms":0,)" + settings + "}";
    std::int64_t samples = 0;
    for (Json reply = ask_well(page, request);; reply = ask_well(page, request)) {
      const Json* unfinished = reply.find("unfinished");
      if (unfinished == nullptr) {
        CHECK(reply.at("hash").text() == whole);
        break;
      }
      REQUIRE(unfinished->integer() > samples);
      samples = unfinished->integer();
    }
    CHECK(samples >= 32);
    // Another frame, or another scene, forgets what has begun.
    ask_well(page, request);
    CHECK(hash_of(page, settings) == whole);
    ask_well(page, request);
    open(page, "cube-room");
    CHECK_FALSE(page.begun);
    page.cancel = 1;
    CHECK(ask(page, request).find("cancelled") != nullptr);
    page.cancel = 0;
  }
}

TEST_CASE("a lens alone does not draw anew") {
  Page page;
  open(page, "figures");
  hash_of(page, R"("size":[32,32])");
  const Drawn* const drawn = page.shown->drawn.get();
  hash_of(page, R"("size":[32,32],"f_number":5,"method":"one-pass")");
  CHECK(page.shown->drawn.get() == drawn);
  hash_of(page, R"("size":[32,32],"time":1)");
  CHECK(page.shown->drawn.get() != drawn);
}

TEST_CASE("a coarse frame is the frame of that size, with the radius in its pixels") {
  Page page;
  open(page, "figures");
  const std::string coarse = hash_of(page, R"("size":[64,32],"preview":4,"max_coc_px":12)");
  CHECK(page.pixels.width == 16);
  CHECK(coarse == hash_of(page, R"("size":[16,8],"max_coc_px":3)"));
}

TEST_CASE("the focus at a place is the depth of its pixel") {
  Page page;
  open(page, "portrait");
  const Json reply = ask_well(page, R"({"do":"frame","size":[50,40],"focus":{"at":[0.5,0.99]}})");
  const Json pixel = ask_well(page, R"({"do":"pixel","x":25,"y":39})");
  CHECK(reply.at("focus_m").number() == pixel.at("depth_m").number());
  CHECK(pixel.at("coc_radius_px").number() == 0.0);
}

TEST_CASE("a moved camera is written into the scene's file") {
  const TemporaryDirectory folder;
  Page page;
  for (const std::string scene : {"figures", "dunes"}) {
    CAPTURE(scene);
    open(page, scene);
    const std::string frame =
        R"("size":[48,48],"time":5,"f_number":1.7,"focus":{"m":0.8},"camera":)"
        R"({"position_m":[0.1,0.35,1.2],"target_m":[0,0.05,0.02],"fov_y_degrees":33.3})";
    const std::string hash = hash_of(page, frame);
    const std::string text =
        ask_well(page, R"({"do":"file","name":"scene.toml"})").at("text").text();
    write_file(folder.file("moved.toml"), text);
    open(page, folder.file("moved.toml"));
    CHECK(hash_of(page, R"("size":[48,48],"time":5)") == hash);
  }
}

TEST_CASE("a model's file names the model, and draws what was shown") {
  const TemporaryDirectory folder;
  write_file(folder.file("thing.obj"),
             "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  Page page;
  open(page, folder.file("thing.obj"));
  const std::string hash = hash_of(page, R"("size":[40,40])");
  const std::string max_coc = std::to_string(page.shown->lens->settings.max_coc_px);
  const std::string text = ask_well(page, R"({"do":"file","name":"scene.toml"})").at("text").text();
  write_file(folder.file("thing.toml"), text);
  open(page, folder.file("thing.toml"));
  CHECK(hash_of(page, R"("size":[40,40],"max_coc_px":)" + max_coc) == hash);
}

TEST_CASE("a command repeats the frame, or there is none") {
  Page page;
  open(page, "figures");
  const auto command_of = [&](const std::string& settings) {
    return ask_well(page, R"({"do":"frame","size":[32,16],)" + settings + "}").at("command");
  };
  CHECK(command_of(R"("time":3,"focus":{"at":[0.5,1]},"focal_length_mm":50,"f_number":2.5,)"
                   R"("coc_scale":1,"max_coc_px":24)")
            .text() ==
        "softfocus render figures -o picture.png --json --size 32x16 --frame 3 --method two-pass "
        "--multisample 1 --autofocus 16,15 --focal-length 50 --f-number 2.5 --coc-scale 1 "
        "--max-coc 24");
  CHECK(command_of(R"("dof":false)").text().ends_with("--show pinhole"));
  CHECK(
      command_of(R"("method":"filtered-views","max_coc_px":24)").text().ends_with("--samples 64"));
  CHECK(command_of(R"("method":"surface-splatting","f_number":2,"max_coc_px":24)")
            .text()
            .ends_with("--f-number 2"));
  const std::string moved =
      R"("max_coc_px":24,"camera":{"position_m":[0,0.3,1],"target_m":[0,0,0],"fov_y_degrees":30})";
  CHECK(command_of(moved).text() ==
        "softfocus render scene.toml -o picture.png --json --size 32x16 --method two-pass "
        "--multisample 1 --max-coc 24");
  open(page, "random:1");
  CHECK(command_of(moved).is_null());
}

TEST_CASE("a frame's look: its light, shadows, textures, effect, and as a wireframe") {
  Page page;
  const Json opened = ask_well(page, R"({"do":"open","scene":"cube-room"})");
  const Json& look = opened.at("look");
  CHECK(look.at("light").values().size() == 3);
  CHECK(look.at("light_kind").text() == "point");
  CHECK(look.at("textures").boolean());
  CHECK_FALSE(look.at("impostors").boolean());
  const std::string size = R"("size":[48,32])";
  const std::string plain = hash_of(page, size);
  const auto with = [&](const std::string& settings) { return hash_of(page, size + settings); };
  const std::string shadows = with(R"(,"shadows":"volumes")");
  CHECK(shadows != plain);
  CHECK(with(R"(,"textures":false)") != plain);
  CHECK(with(R"(,"effect":"sharpen")") != plain);
  CHECK(with(R"(,"show":"wireframe")") != plain);
  const std::string moved = with(R"(,"shadows":"volumes","light":[1,2,1])");
  CHECK(moved != shadows);
  const Json counts =
      ask_well(page, R"({"do":"frame",)" + size + R"(,"shadows":"volumes","light":[1.5,2,1]})")
          .at("shadows");
  CHECK(counts.at("triangles").integer() == opened.at("triangles").integer());
  CHECK(counts.at("casters").integer() > 0);
  CHECK(counts.at("volumes").integer() > 0);
  CHECK(counts.at("projected").integer() == 0);
  // In any order, the same.
  CHECK(with(R"(,"shadows":"volumes","light":[1,2,1])") == moved);
  CHECK(with("") == plain);
  open(page, "portrait");
  const std::string as_it_is = with(R"(,"dof":false)");
  CHECK(with(R"(,"dof":false,"backdrop_m":9)") != as_it_is);
  CHECK(with(R"(,"dof":false,"backdrop_m":9,"shadows":"volumes","light":[1,2,1])") !=
        with(R"(,"dof":false,"shadows":"volumes","light":[1,2,1])"));
  CHECK(with(R"(,"dof":false)") == as_it_is);
  for (const char* const wrong : {R"("shadows":"soft")", R"("light":[0,0,0])", R"("light":[1,2])",
                                  R"("effect":"bloo")", R"("impostors":"on")"}) {
    CAPTURE(wrong);
    CHECK(ask(page, R"({"do":"frame",)" + std::string{wrong} + "}").find("error") != nullptr);
  }
}

TEST_CASE("every scene's frame has the picture_hash of the page's command" *
          doctest::test_suite("long")) {
  const TemporaryDirectory folder;
  Page page;
  const auto check = [&](const std::string& settings) {
    const Json frame = ask_well(page, R"({"do":"frame","size":[40,24],)" + settings + "}");
    write_file(folder.file("scene.toml"), "");
    std::vector<std::string> words = words_of(frame.at("command").text());
    REQUIRE(words.size() > 4);
    words.erase(words.begin());
    for (std::string& word : words) {
      if (word == "scene.toml") {
        word = folder.file(word);
        write_file(word, ask_well(page, R"({"do":"file","name":"scene.toml"})").at("text").text());
      } else if (word == "picture.png") {
        word = folder.file("picture.npy");
      }
    }
    CAPTURE(frame.at("command").text());
    const ProgramRun run = run_program(words);
    CAPTURE(run.err);
    REQUIRE(run.status == 0);
    const std::optional<Json> report = parse_json(run.out);
    REQUIRE(report);
    CHECK(frame.at("hash").text() == report->at("picture_hash").text());
  };
  const Json scenes = ask_well(page, R"({"do":"scenes"})").at("scenes");
  for (const Json& listed : scenes.values()) {
    open(page, listed.at("name").text());
    check(R"("time":2,"method":"disc-layers")");
    check(R"("f_number":1.5,"focus":{"at":[0.3,0.7]},"max_coc_px":7.5)");
  }
  open(page, "windmill");
  for (const char* const method : {"accumulation", "filtered-views", "warped-accumulation"}) {
    check(R"("time":1,"samples":17,"method":")" + std::string{method} + "\"");
  }
  open(page, "glass");
  for (const char* const method : {"layered", "pinhole", "object-identification", "scatter"}) {
    check(R"("method":")" + std::string{method} + "\"");
  }
  check(R"("show":"coc","coc_scale":4)");
  check(R"("show":"depth")");
  check(R"("show":"wireframe")");
  open(page, "cube-room");
  check(R"("shadows":"projected","light":[0.25,2,1.5],"textures":false)");
  check(R"("shadows":"volumes","effect":"gaussian:sigma=1","impostors":"auto")");
  open(page, "glass");
  check(R"("dof":false)");
  open(page, "portrait");
  check(R"("backdrop_m":9.5)");
  check(
      R"("backdrop_m":20,"camera":{"position_m":[0,1.6,1.5],"target_m":[0,9,-2],"fov_y_degrees":90})");
  check(
      R"("method":"scatter-aperture","aperture_blades":5,"aperture_turn_degrees":-12.5,"anamorphic":1.5)");
  check(R"("method":"accumulation","samples":16,"aperture_blades":6,"anamorphic":2)");
  check(R"("method":"two-pass","aperture_blades":6)");
  const std::string camera =
      R"(,"camera":{"position_m":[1,1.5,4],"target_m":[0,0.5,0],"fov_y_degrees":30})";
  // Effects and the shutter, with the scene's camera and with another.
  for (const std::string effects :
       {"[[effect]]\nname = \"motion-blur\"\nshutter = 2\n[[effect]]\nname = \"bloom\"\n",
        "[[effect]]\nname = \"temporal-aa\"\n"}) {
    const std::string own = folder.file("own.toml");
    write_file(own,
               "[camera]\nposition = [0, 1, 5]\norbit_degrees_per_frame = 3\nshutter = 1\n"
               "[[light]]\nkind = \"directional\"\ndirection = [1, 2, 3]\n"
               "[material.red]\ndiffuse = [0.9, 0.2, 0.1]\n"
               "[[object]]\nshape = \"cube\"\nmaterial = \"red\"\n"
               "spin_degrees_per_frame = [0, 9, 0]\n" +
                   effects);
    open(page, own);
    for (const std::string& seen_by : {std::string{}, camera}) {
      check(R"("time":4,"method":"one-pass")" + seen_by);
      check(R"("dof":false,"time":4)" + seen_by);
      if (!contains(effects, "temporal-aa")) {
        check(R"("time":4,"samples":9,"method":"accumulation")" + seen_by);
      }
    }
  }
}

TEST_CASE("the truth is accumulation's picture of many views, and its distance the mean FLIP" *
          doctest::test_suite("long")) {
  Page page;
  open(page, "clutter");
  hash_of(page, R"("size":[40,24])");
  ask_well(page, R"({"do":"truth","views":9})");
  const Json reply = ask_well(page, R"({"do":"truth","views":290,"hash":true,"show":"truth"})");
  const auto samples = static_cast<int>(reply.at("samples").integer());
  CHECK(samples > kMostFewLensPoints);
  CHECK(reply.at("half_set_rms").number() > 0.0);
  const Image shown = page.shown->picture;
  const std::string hash = hash_of(
      page, R"("size":[40,24],"method":"accumulation","samples":)" + std::to_string(samples));
  CHECK(reply.at("hash").text() == hash);
  CHECK(reply.at("flip_mean").number() == mean_flip(page.shown->picture, shown, *page.pool));
  CHECK(reply.at("width").integer() == 40);
}

TEST_CASE("the truth has the aperture's blades, turned and stretched as the method has them") {
  const TemporaryDirectory folder;
  write_file(folder.file("lights.toml"),
             "[material.lamp]\nlit = false\ndiffuse = [1, 1, 1]\n[[scatter]]\nshape = \"sphere\"\n"
             "radius = 0.05\nmaterials = [\"lamp\"]\ncount = 5\nregion_min = [-0.7, -0.7, -1]\n"
             "region_max = [0.7, 0.7, 0]\n");
  Page page;
  open(page, folder.file("lights.toml"));
  const std::string frame =
      R"("size":[96,96],"focus":{"m":1},"coc_scale":6,"max_coc_px":64,"method":"scatter-aperture","aperture_blades":3,)"
      R"("aperture_turn_degrees":)";
  // Held against its own truth, and against those of other turns and stretches.
  const std::string own = frame + R"(40,"anamorphic":3)";
  hash_of(page, own);
  const Image picture = page.shown->picture;
  const auto flip_against = [&](const std::string& settings) {
    hash_of(page, settings);
    page.shown->picture = picture;
    return ask_well(page, R"({"do":"truth","views":512})").at("flip_mean").number();
  };
  const double own_flip = flip_against(own);
  for (const char* const other : {R"(40,"anamorphic":0.33)", R"(-40,"anamorphic":3)", "40"}) {
    CAPTURE(other);
    CHECK(flip_against(frame + other) > 1.3 * own_flip);
  }
  for (const char* const wrong :
       {R"("aperture_blades":2)", R"("aperture_blades":3.5)", R"("anamorphic":0)",
        R"("highlight_gain":0.5)", R"("backdrop_m":9)"}) {
    CAPTURE(wrong);
    CHECK(ask(page, R"({"do":"frame","method":"scatter-aperture",)" + std::string{wrong} + "}")
              .find("error") != nullptr);
  }
}

TEST_CASE("another lens begins its truth anew") {
  Page page;
  open(page, "clutter");
  hash_of(page, R"("size":[24,24])");
  ask_well(page, R"({"do":"truth","views":24})");
  hash_of(page, R"("size":[24,24],"f_number":9)");
  CHECK(ask(page, R"({"do":"truth"})").find("error") != nullptr);
  CHECK(ask_well(page, R"({"do":"truth","views":8})").at("samples").integer() == 8);
}

TEST_CASE("methods are compared with the truth of the frame") {
  Page page;
  open(page, "clutter");
  hash_of(page, R"("size":[32,32],"max_coc_px":4,"coc_scale":8)");
  const Json truth = ask_well(page, R"({"do":"truth","views":32})");
  const Json reply =
      ask_well(page, R"({"do":"compare_methods","methods":["pinhole","two-pass"],"radii":[4]})");
  const auto& results = reply.at("results").values();
  REQUIRE(results.size() == 2);
  CHECK(results[1].at("flip_mean").number() == truth.at("flip_mean").number());
  CHECK(results[0].at("flip_mean").number() > results[1].at("flip_mean").number());
}

TEST_CASE("a case of the atlas has its own circles, and a wider lens larger ones") {
  Page page;
  const Json opened = ask_well(page, R"({"do":"open","case":"borders","value":8})");
  const Json& lens = opened.at("lens");
  const std::string given = R"("size":[64,64],"focal_length_mm":)" +
                            json_text(lens.at("focal_length_mm")) + R"(,"f_number":)" +
                            json_text(lens.at("f_number")) + R"(,"focus":{"m":)" +
                            json_text(lens.at("focus_m")) + "}";
  const Json frame = ask_well(page, R"({"do":"frame",)" + given + "}");
  CHECK(page.shown->lens->settings.coc.radius_at_infinity_px == 16.0f);
  CHECK(frame.at("largest_coc_px").number() == doctest::Approx(8.0).epsilon(0.01));
  ask_well(page, R"({"do":"frame","size":[64,64],"f_number":1})");
  CHECK(page.shown->lens->settings.coc.radius_at_infinity_px == 32.0f);
  const Json truth = ask_well(page, R"({"do":"truth","views":8})");
  CHECK(truth.at("done").boolean());
}

TEST_CASE("every case opens at its telling severity and makes a frame" *
          doctest::test_suite("long")) {
  Page page;
  const Json listed = ask_well(page, R"({"do":"scenes"})");
  for (const Json& known : listed.at("cases").values()) {
    const std::string name = known.at("name").text();
    CAPTURE(name);
    ask_well(page, R"({"do":"open","case":")" + name + "\"}");
    ask_well(page, R"({"do":"frame","size":[24,16]})");
  }
}

TEST_CASE("what is wrong is one line, and the frame stays") {
  Page page;
  open(page, "figures");
  const std::string hash = hash_of(page, R"("size":[16,16])");
  for (const char* const request :
       {"", "{", "[]", "{}", R"({"do":7})", R"({"do":"nothing"})",
        R"({"do":"open","scene":"nowhere"})", R"({"do":"open","case":"borders","value":1e9})",
        R"({"do":"frame","size":[0,4]})", R"({"do":"frame","size":[4]})",
        R"({"do":"frame","method":"auto"})", R"({"do":"frame","samples":2.5})",
        R"({"do":"frame","f_number":0})", R"({"do":"frame","focus":{"at":[2,0]}})",
        R"({"do":"frame","focal_length_mm":900,"focus":{"m":0.5}})",
        R"({"do":"pixel","x":16,"y":0})", R"({"do":"truth","show":"error"})",
        R"({"do":"file","name":"/etc/passwd"})"}) {
    CAPTURE(request);
    const Json reply = ask(page, request);
    REQUIRE(reply.find("error") != nullptr);
    CHECK(!contains(reply.at("error").text(), "\n"));
    CHECK(reply.at("error").text() != "");
  }
  CHECK(hash_text(page.shown->hash) == hash);
  CHECK(hash_of(page, R"("size":[16,16])") == hash);
}

TEST_CASE("the self-test comes in slices of any size") {
  Page page;
  const Json some = ask_well(page, R"({"do":"selftest","first":0,"count":3})");
  const Json next = ask_well(page, R"({"do":"selftest","first":3,"count":2})");
  CHECK(some.at("results").values().size() == 3);
  REQUIRE(next.at("results").values().size() == 2);
  CHECK(next.at("results").at(std::size_t{0}).at("equal").boolean());
  CHECK(some.at("total").integer() == static_cast<int>(member_count(expected_groups())));
  const Json quick = ask_well(page, R"({"do":"selftest","quick":true,"first":0,"count":1})");
  CHECK(quick.at("total").integer() ==
        static_cast<int>(member_count(expected_groups(GoldenSet::quick))));
}

TEST_CASE("the GPU's frame is the module's under the driver's profile, stage by stage") {
  if (!has_driver("llvmpipe")) return;
  Page page;
  open(page, "cube-room");
  const std::string settings = R"({"do":"gl_frame","size":[96,64],"max_coc_px":5,)";
  CHECK(ask(page, settings + R"("gl_show":"picture"})").find("error") != nullptr);
  const Json opened = ask_well(page, R"({"do":"gl_open"})");
  CHECK(opened.at("profile").text().starts_with("llvmpipe"));
  const Json reply = ask_well(page, settings + R"("gl_show":"difference"})");
  for (const char* stage : {"draw", "filter", "frame"}) {
    const Json& differing = reply.at("differing").at(stage);
    CHECK(differing.at("values").integer() == 0);
    CHECK(differing.at("of").integer() == 96 * 64 * 4);
  }
  CHECK(ask_well(page, R"({"do":"gl_frame","gl_show":"picture"})").at("width").integer() == 96);
  CHECK(ask(page, settings + R"("gl_show":"all"})").find("error") != nullptr);

  const Json cases = ask_well(page, R"({"do":"gl_crosscheck"})");
  CHECK(cases.at("cases").values().size() > 200);
  const Json one = ask_well(page, R"({"do":"gl_crosscheck","case":"store/rgba8-random"})");
  CHECK(one.at("differing").integer() == 0);
  CHECK(one.at("values").integer() == 256 * 256 * 4);
  CHECK(ask(page, R"({"do":"gl_crosscheck","case":"none"})").find("error") != nullptr);

  // A case that is made as a picture has no drawing.
  const Json list = ask_well(page, R"({"do":"scenes"})").at("cases");
  ask_well(page, R"({"do":"open","case":")" + list.values()[0].at("name").text() + "\"}");
  const Json of_case = ask_well(page, R"({"do":"gl_frame","size":[64,64],"gl_show":"difference"})");
  CHECK(of_case.at("differing").find("draw") == nullptr);
  CHECK(of_case.at("differing").at("filter").at("values").integer() == 0);
}

namespace {

/// What the page's compiler sends of a text.
Json compiled(const std::string& text) {
  const auto none = [](const std::string&) { return std::optional<std::string>{}; };
  return compiled_json(compile_glsl({.name = "mine.frag", .text = text}, none));
}

/// two-pass as a text of the visitor's.
Json two_pass_request(Page& page) {
  const Json text = ask_well(page, R"({"do":"shader_text","name":"two_pass.frag"})");
  return {{"do", "shader"},
          {"name", "mine.frag"},
          {"compiled", compiled(text.at("text").text())},
          {"passes", R"(
[[pass]]
shader = "mine.frag"
uniforms = { direction = [1, 0], taps = "ceil(max_coc_px) - 1" }
[[pass]]
shader = "mine.frag"
uniforms = { direction = [0, 1], taps = "ceil(max_coc_px) - 1" }
)"}};
}

std::string method_of(Page& page, const Json& request) {
  return ask_well(page, json_text(request)).at("method").text();
}

}  // namespace

TEST_CASE("a shader of the visitor's is a method: two-pass as a text has the bits of two-pass") {
  if (!missing_glsl().empty()) return;
  Page page;
  open(page, "figures");
  const std::string method = method_of(page, two_pass_request(page));
  const std::string settings = R"("size":[64,48],"coc_scale":3,"method":")";
  CHECK(hash_of(page, settings + method + "\"") == hash_of(page, settings + "two-pass\""));
  CHECK(method_of(page, two_pass_request(page)) == method);
  ask_well(page, R"({"do":"frame","size":[64,48],"method":")" + method + "\"}");
  CHECK(ask_well(page, R"({"do":"truth","views":4})").at("flip_mean").number() > 0.0);
}

TEST_CASE(
    "passes that are wrong are told by their line, and no shader but the visitor's is there") {
  if (!missing_glsl().empty()) return;
  Page page;
  Json request = two_pass_request(page);
  const auto error_with = [&](const char* passes) {
    request["passes"] = passes;
    return ask(page, json_text(request)).at("error").text();
  };
  CHECK(error_with("[[pass]]\nshader = 1").starts_with("mine.toml:2: "));
  CHECK(error_with("[[pass]]\nshader = \"one_pass.frag\"").find("\"mine.frag\" would be right") !=
        std::string::npos);
  CHECK(error_with("").find("[[pass]]") != std::string::npos);
  CHECK(error_with("[[pass]]\nshader = \"mine.frag\"\nconvention = \"shadertoy\"")
            .find("taken for plain") != std::string::npos);
  CHECK(error_with("[[pass]]\nshader = \"mine.frag\"\ndefines = { A = 1 }")
            .find("the page has no `defines`") != std::string::npos);
  CHECK(ask(page, R"({"do":"shader_text","name":"none.frag"})").find("error") != nullptr);
}

TEST_CASE("a shader of the visitor's has the GPU's bits, from the same text") {
  if (!missing_glsl().empty() || !has_driver("llvmpipe")) return;
  Page page;
  open(page, "figures");
  const std::string method = method_of(page, two_pass_request(page));
  const Json reply =
      ask_well(page, R"({"do":"gl_frame","size":[96,64],"gl_show":"difference","method":")" +
                         method + "\"}");
  CHECK(reply.at("differing").at("filter").at("of").integer() == 96 * 64 * 4);
  CHECK(reply.at("differing").at("filter").at("values").integer() == 0);
  CHECK(ask_well(page, R"({"do":"gl_frame","gl_show":"emulated"})").at("width").integer() == 96);
}

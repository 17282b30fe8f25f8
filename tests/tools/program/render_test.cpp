#include <map>

#include <nlohmann/json.hpp>

#include "dof/dof.h"
#include "dof/measure/difference.h"
#include "raster/images/texel.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/draw/object_numbers.h"
#include "scenes/load/load_scene.h"
#include "tests/support/cli_render.h"
#include "tests/support/sanitizers.h"

using namespace softfocus;

namespace {

/// A square of 2 m, 4 m in front of the camera, before a far background.
constexpr std::string_view kSquareObj = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n";

}  // namespace

TEST_CASE("render: a picture is 1024 x 1024 if no size is given") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("a.npy");
  CHECK(run_program({"render", "figures", "-o", file}).status == 0);
  const std::string bytes = read_file(file);
  CHECK(contains(bytes.substr(0, 128), "'shape': (1024, 1024, 4)"));
  CHECK(bytes.size() == 128 + 1024 * 1024 * 8);
}

// Other methods: picture_methods_test.cpp.
TEST_CASE("render: the bytes are the same for 1, 2, 3 and 8 threads" *
          doctest::test_suite("threads")) {
  const auto with_threads = [&](const std::string& threads) {
    return rendered("figures", {"--max-coc", "6", "--threads", threads});
  };
  const std::string one = with_threads("1");
  for (const std::string threads : {"2", "3", "8"}) CHECK(with_threads(threads) == one);
}

TEST_CASE("render: a large picture is made by rows, with the whole one's bytes and words") {
  const TemporaryDirectory directory;
  const std::string rows = directory.file("rows.npy"), whole = directory.file("whole.npy");
  const auto large = [](const std::string& output, const Words& more) {
    Words words{"render", "figures",   "--size", "4096x1024", "--method", "two-pass",
                "--json", "--max-coc", "2",      "-o",        output};
    words.insert(words.end(), more.begin(), more.end());
    ProgramRun run = run_program(words);
    CHECK(run.status == 0);
    return run;
  };
  const std::string report = directory.file("report.txt");
  const ProgramRun by_rows = large(rows, {"--report", report});
  const ProgramRun at_once = large(whole, {"--depth-output", directory.file("depth.pfm")});
  CHECK(read_file(rows) == read_file(whole));
  CHECK(by_rows.err == at_once.err);
  CHECK(nlohmann::json::parse(by_rows.out)["picture_hash"] ==
        nlohmann::json::parse(at_once.out)["picture_hash"]);
  CHECK(nlohmann::json::parse(read_file(rows + ".json"))["picture_hash"] ==
        nlohmann::json::parse(read_file(whole + ".json"))["picture_hash"]);
  // Sanitizers take memory of their own.
  if (!kHasSanitizers) CHECK(by_rows.peak_kib < at_once.peak_kib);
  CHECK(contains(read_file(report), "a band of rows at a time"));
  const auto times = nlohmann::json::parse(by_rows.out);
  CHECK(times["with_depth_of_field"]["ms"] > times["without_depth_of_field"]["ms"]);
}

TEST_CASE("render: a method that reads object numbers gets those of the scene's objects") {
  const Scene scene = load_scene("near-fence", scene_search_path({}));
  const CameraMatrices view = camera_matrices(scene.camera, 0, kWidth, kHeight);
  ThreadPool pool(2);
  const Image drawn = draw_scene(scene, view, 0, kWidth, kHeight, {}, pool);
  const DofSettings settings{
      .coc = pixel_coc(scene.lens.lens, scene.camera.fov_y_degrees, kHeight, scene.lens.coc_scale),
      .max_coc_px = 16.0f};
  const std::vector<std::uint16_t> numbers =
      draw_object_numbers(scene, view, 0, kWidth, kHeight, {}, pool);
  const Method& method = *find_method("object-identification");
  const Image with = apply(method, {drawn, settings, {}, numbers}, pool);
  const Image without = apply(method, {drawn, settings, {}}, pool);
  CHECK_FALSE(equal(with, without));
  const Picture picture =
      rendered_picture("near-fence", {"--method", "object-identification", "--max-coc", "16"});
  CHECK(equal(picture.image, with));
}

TEST_CASE("render: the built-in scenes give different pictures, each with something in it") {
  std::vector<std::string> pictures;
  for (const std::string scene : {"figures", "cube-room", "sphere-world"}) {
    pictures.push_back(rendered(scene, {"--max-coc", "1"}, "a.png"));
    CHECK(pictures.back().size() > 500);  // a picture of one colour takes less
  }
  CHECK(pictures[0] != pictures[1]);
  CHECK(pictures[1] != pictures[2]);
}

TEST_CASE("render: a scene's file can be given instead of its name") {
  const TemporaryDirectory directory;
  const std::string name = directory.file("mine.toml");
  write_file(directory.file("square.obj"), kSquareObj);
  write_file(name, "title = \"Mine\"\n[[object]]\nshape = \"model\"\nfile = \"square.obj\"\n");
  CHECK(rendered_json(name, {})["title"] == "Mine");
  CHECK(rendered_json(name, {})["triangles"] == 2);
}

TEST_CASE("render: an OBJ model can be given as a scene") {
  const TemporaryDirectory directory;
  write_file(directory.file("square.obj"), kSquareObj);
  const auto json = rendered_json(directory.file("square.obj"), {});
  CHECK(json["scene"] == "square");
  CHECK(json["triangles"] == 2);
}

TEST_CASE("render: --scene-path is looked through first, in the order given") {
  const TemporaryDirectory first, second;
  write_file(first.file("figures.toml"), "title = \"First\"\n" + kCube);
  write_file(second.file("figures.toml"), "title = \"Second\"\n" + kCube);
  write_file(second.file("other.toml"), "title = \"Other\"\n" + kCube);
  const Words path{"--scene-path", first.path(), "--scene-path", second.path()};
  CHECK(rendered_json("figures", path)["title"] == "First");
  CHECK(rendered_json("other", path)["title"] == "Other");
  CHECK(rendered_json("figures", {})["title"] == "Figures");
}

TEST_CASE(
    "render: the methods give different pictures, and without one the best of its price is taken") {
  const auto by_method = [](const std::string& method) {
    return rendered("figures", {"--max-coc", "6", "--method", method});
  };
  CHECK(by_method("pinhole") != by_method("two-pass"));
  CHECK(by_method("two-pass") != by_method("one-pass"));
  CHECK(by_method("one-pass") != by_method("pinhole"));
  const std::string best = by_method("disc-layers"), shaders = by_method("two-pass");
  CHECK(rendered("figures", {"--max-coc", "6"}) == best);
  CHECK(rendered("figures", {"--max-coc", "6", "--profile", "ieee"}) == best);
  CHECK(rendered("figures", {"--max-coc", "6", "--leak", "1"}) == shaders);
  const Words direct{"--max-coc", "6", "--profile", "d3d11"};
  Words with_shaders = direct;
  with_shaders.insert(with_shaders.end(), {"--method", "two-pass"});
  CHECK(rendered("figures", direct) == rendered("figures", with_shaders));
}

TEST_CASE("render: the pinhole method gives the picture before any filter") {
  const std::string before = rendered("figures", {"--show", "pinhole"});
  CHECK(rendered("figures", {"--method", "pinhole"}) == before);
}

TEST_CASE("render: circles of no size blur nothing") {
  const std::string before = rendered("figures", {"--show", "pinhole"});
  for (const std::string method : {"two-pass", "one-pass"}) {
    CHECK(rendered("figures", {"--coc-scale", "0", "--max-coc", "6", "--method", method}) ==
          before);
    CHECK(rendered("figures", {"--max-coc", "0", "--method", method}) == before);
  }
}

TEST_CASE("render: the pinhole method minds no lens") {
  CHECK(rendered("figures", {"--method", "pinhole", "--focal-length", "3000"}) ==
        rendered("figures", {"--method", "pinhole"}));
}

TEST_CASE("render: every lens and filter option is used as given") {
  const auto json =
      rendered_json("figures", {"--focus", "1.25", "--focal-length", "40", "--f-number", "4",
                                "--coc-scale", "1.5", "--max-coc", "12", "--leak", "0.5"});
  const auto& lens = json["lens"];
  CHECK(lens["focus_m"] == 1.25);
  CHECK(lens["focal_length_mm"] == 40.0);
  CHECK(lens["f_number"] == 4.0);
  CHECK(lens["aperture_mm"] == 10.0);
  CHECK(lens["coc_scale"] == 1.5);
  CHECK(lens["max_coc_px"] == 12.0);
  CHECK(lens["leak"] == 0.5);
}

TEST_CASE("render: every lens and filter option changes the picture") {
  using Options = std::map<std::string, std::string>;
  const auto rendered_with = [](const Options& options) {
    Words words;
    for (const auto& [name, value] : options) {
      words.push_back(name);
      words.back().append("=").append(value);
    }
    return rendered("figures", words);
  };
  // Larger circles than so small a picture has by itself, and some past the limit.
  const Options usual{{"--coc-scale", "2"}, {"--max-coc", "4"}, {"--method", "two-pass"}};
  const std::string before = rendered_with(usual);
  const Options other{{"--focus", "0.9"},     {"--focal-length", "60"}, {"--f-number", "4"},
                      {"--coc-scale", "3"},   {"--max-coc", "2"},       {"--leak", "0"},
                      {"--autofocus", "0,0"}, {"--profile", "d3d11"}};
  for (const auto& option : other) {
    CAPTURE(option.first);
    Options changed = usual;
    changed[option.first] = option.second;
    CHECK(rendered_with(changed) != before);
  }
}

TEST_CASE("render: the filter size follows the picture's height if it is not given") {
  const TemporaryDirectory directory;
  const auto max_coc = [&](const char* size) {
    const ProgramRun run = run_program({"render", "figures", "--size", size, "--method", "two-pass",
                                        "-o", directory.file("a.png"), "--json"});
    return nlohmann::json::parse(run.out)["lens"]["max_coc_px"].get<double>();
  };
  CHECK(max_coc("48x32") == 16.0 * 32 / 1024);
  CHECK(max_coc("32x64") == 16.0 * 64 / 1024);
}

TEST_CASE("render: a filter size of 128 and more is taken") {
  CHECK_FALSE(rendered("figures", {"--max-coc", "128"}).empty());
  CHECK_FALSE(rendered("figures", {"--max-coc", "1024"}).empty());
}

TEST_CASE("render: --autofocus focuses on the depth at the pixel") {
  const Image before = rendered_picture("figures", {"--show", "pinhole"}).image;
  const double depth = static_cast<double>(load_texel(before, 30, 12).w);
  const auto lens = rendered_json("figures", {"--autofocus", "30,12"})["lens"];
  CHECK(lens["focus_m"] == depth);
  CHECK(lens["autofocus_pixel"] == nlohmann::json{30, 12});
}

TEST_CASE("render: --autofocus gives the picture that --focus at the found distance gives") {
  const auto found = rendered_json("figures", {"--autofocus", "30,12"})["lens"]["focus_m"];
  CHECK(rendered("figures", {"--focus", found.dump()}) ==
        rendered("figures", {"--autofocus", "30,12"}));
}

TEST_CASE("render: --autofocus of a model finds it where the picture's middle does not show it") {
  const TemporaryDirectory directory;
  const std::string ring = directory.file("ring.obj");
  // A frame with nothing in its middle.
  write_file(ring,
             "v -3 -3 0\nv 3 -3 0\nv 3 3 0\nv -3 3 0\nv -2 -2 0\nv 2 -2 0\nv 2 2 0\n"
             "v -2 2 0\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
  const auto lens = rendered_json(ring, {"--autofocus"})["lens"];
  const auto own = rendered_json(ring, {})["lens"];
  CHECK(lens["focus_m"].get<double>() ==
        doctest::Approx(own["focus_m"].get<double>()).epsilon(0.2));
  CHECK(own["focal_length_mm"] == 50.0);
  CHECK(own["f_number"] == 2.0);
}

TEST_CASE("render: --autofocus without a pixel takes the centre, wherever it stands") {
  const std::string centre = rendered("figures", {"--autofocus", "24,16"});
  CHECK(rendered("figures", {"--autofocus"}) == centre);
  CHECK(rendered("figures", {"--autofocus=24,16"}) == centre);
  CHECK(rendered("figures", {"--focus-at", "24,16"}) == centre);
  CHECK(rendered("figures", {"--autofocus", "centre"}) == centre);
  CHECK(rendered("figures", {"--autofocus", "--threads", "1"}) == centre);
  const TemporaryDirectory directory;
  const std::string file = directory.file("a.npy");
  CHECK(run_program(
            {"render", "--autofocus", "figures", "--size", kSize, "-o", file, "--multisample", "1"})
            .status == 0);
  CHECK(read_file(file) == centre);
}

TEST_CASE("render: --frame moves what is animated, by fractions too") {
  const std::string start = rendered("cube-room", {});
  CHECK(rendered("cube-room", {"--frame", "0"}) == start);
  CHECK(rendered("cube-room", {"--frame", "10"}) != start);
  CHECK(rendered("cube-room", {"--frame", "10"}) != rendered("cube-room", {"--frame", "10.5"}));
}

TEST_CASE("render: every profile is taken") {
  for (const std::string profile : {"ieee", "d3d11", "llvmpipe", "llvmpipe-sse41", "softpipe"}) {
    CHECK(rendered_json("figures", {"--profile", profile})["profile"] == profile);
  }
}

TEST_CASE("render: --show coc is grey, and black where the focus was found") {
  const Image map = rendered_picture("figures", {"--show", "coc", "--autofocus", "30,12"}).image;
  CHECK(load_texel(map, 30, 12).x == 0.0f);
  bool all_grey = true, some_light = false;
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      const glm::vec4 texel = load_texel(map, x, y);
      all_grey = all_grey && texel.x == texel.y && texel.y == texel.z;
      some_light = some_light || texel.x > 0.5f;
    }
  }
  CHECK(all_grey);
  CHECK(some_light);
}

TEST_CASE("render: --show wireframe has the drawing along triangles' edges and nothing between") {
  const TemporaryDirectory folder;
  const std::string scene = folder.file("cube.toml");
  write_file(scene, "background = [0.3, 0.4, 0.5]\n" + kCube + "cells = 1\n");
  const Image wires = rendered_picture(scene, {"--show", "wireframe"}).image;
  const Image drawn = rendered_picture(scene, {"--show", "pinhole"}).image;
  const glm::vec3 background{load_texel(drawn, 0, 0)};
  int lines = 0, between = 0, other = 0;
  for (int y = 0; y < wires.height; ++y) {
    for (int x = 0; x < wires.width; ++x) {
      const glm::vec3 surface{load_texel(drawn, x, y)}, wire{load_texel(wires, x, y)};
      if (surface == background) {
        other += wire == background ? 0 : 1;
      } else {
        (wire == surface ? lines : wire == background ? between : other) += 1;
      }
    }
  }
  CHECK(other == 0);
  CHECK(lines > 20);
  CHECK(between > lines);
}

TEST_CASE("render: --show depth is lighter where it is farther") {
  const Image map = rendered_picture("figures", {"--show", "depth"}).image;
  const Image before = rendered_picture("figures", {"--show", "pinhole"}).image;
  const glm::vec4 near = load_texel(map, 24, 16), far = load_texel(map, 0, 0);
  REQUIRE(load_texel(before, 24, 16).w < load_texel(before, 0, 0).w);
  CHECK(near.x < far.x);
  CHECK(far.x == 1.0f);
}

#include "scenes/load/load_scene.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "raster/numbers/exact_math.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/load/model_scene.h"
#include "tests/support/scene_test_files.h"

using namespace softfocus;
using namespace softfocus::test;

namespace {

Scene built_in(std::string_view name) { return load_scene(name, scene_search_path({})); }

// The signed circle of confusion of a scene's lens, in pixels of a picture of 1024 rows.
double coc_px(const Scene& scene, double depth_m) {
  const PixelCoc coc =
      pixel_coc(scene.lens.lens, scene.camera.fov_y_degrees, 1024, scene.lens.coc_scale);
  return coc_radius_px(coc, static_cast<float>(depth_m));
}

double depth_of(const Scene& scene, glm::dvec3 place) {
  const glm::dvec4 eye =
      camera_matrices(scene.camera, 0, 1024, 1024).world_to_eye * glm::dvec4{place, 1.0};
  return -eye.z;
}

// A wedge 2 wide, 1 high and 4 deep, `size` times that.
std::string wedge(double size) {
  const std::string s = std::to_string(size);
  const std::string d = std::to_string(4 * size);
  return "v 0 0 0\nv " + s + " 0 0\nv 0 " + s + " 0\nv 0 0 -" + d + "\nv " + s + " 0 -" + d +
         "\nf 1 2 3\nf 2 5 3\nf 4 1 3\nf 5 4 3\nf 1 4 5 2\n";
}

Scene model_scene(const std::string& obj) {
  const TemporaryDirectory directory;
  write_file(directory.file("thing.obj"), obj);
  return load_scene(directory.file("thing.obj"), {});
}

}  // namespace

TEST_CASE("the three scenes of the thesis are found and load without a warning") {
  const auto listings = list_scenes(scene_search_path({}));
  for (const char* name : {"figures", "cube-room", "sphere-world"}) {
    CAPTURE(name);
    CHECK(std::any_of(listings.begin(), listings.end(),
                      [&](const SceneListing& l) { return l.name == name && !l.title.empty(); }));
    CHECK(built_in(name).warnings.empty());
  }
}

TEST_CASE("Figures is five lit objects of one colour each and no texture, and stands still") {
  const Scene scene = built_in("figures");
  CHECK(scene.objects.size() == 5);
  CHECK(scene.textures.empty());
  CHECK_FALSE(scene.lights.empty());
  std::set<std::uint32_t> materials;
  for (const Object& object : scene.objects) {
    materials.insert(object.material);
    CHECK(scene.materials[object.material].lit);
    CHECK(object.spin_degrees_per_frame == glm::dvec3{0.0});
    CHECK(object.sway == glm::dvec3{0.0});
  }
  CHECK(materials.size() == 5);
}

TEST_CASE("in Figures the cone is in focus and the others are not") {
  const Scene scene = built_in("figures");
  for (std::size_t i = 0; i < 5; ++i) {
    const double blur = std::fabs(coc_px(scene, depth_of(scene, scene.objects[i].position)));
    if (i == 0) {
      CHECK(blur < 2.0);
    } else {
      CHECK(blur > 5.0);
    }
  }
}

TEST_CASE("the room of cubes is five cubes in a sixth, all textured, the walls otherwise") {
  const Scene scene = built_in("cube-room");
  REQUIRE(scene.objects.size() == 6);
  const auto wall = scene.materials[scene.objects[0].material].texture;
  for (std::size_t i = 0; i < 6; ++i) {
    const auto texture = scene.materials[scene.objects[i].material].texture;
    CHECK(texture);
    if (i > 0) CHECK(texture != wall);
    if (i > 0) CHECK(scene.objects[i].spin_degrees_per_frame != glm::dvec3{0.0});
    if (i > 0) CHECK(scene.objects[i].sway == scene.objects[1].sway);
  }
}

TEST_CASE("in the room of cubes the last cube is in focus at first, and all stay in the room") {
  const Scene scene = built_in("cube-room");
  double before = 0.0;
  for (std::size_t i = 1; i < 6; ++i) {
    const Object& cube = scene.objects[i];
    const double depth = depth_of(scene, cube.position);
    CHECK(depth > before);  // a file: each behind the one before
    before = depth;
    CHECK(depth_of(scene, cube.position + cube.sway) > 0.2);
  }
  CHECK(std::fabs(coc_px(scene, before)) < 1.0);
  CHECK(std::fabs(coc_px(scene, depth_of(scene, scene.objects[1].position))) > 8.0);
}

TEST_CASE("the world of spheres is 250 spheres, a torus and a floor of 1680 triangles") {
  const Scene scene = built_in("sphere-world");
  REQUIRE(scene.objects.size() == 252);
  CHECK(scene.meshes[scene.objects[0].mesh].indices.size() == 3 * 1680);
  CHECK(scene.meshes.size() == 3);
  std::size_t spheres = 0;
  for (const Object& object : scene.objects) {
    if (object.mesh == scene.objects[2].mesh) ++spheres;
    CHECK(scene.materials[object.material].texture);
  }
  CHECK(spheres == 250);
  CHECK(triangle_count(scene) == 1680 + 2 * 128 * 64 + 250 * 2 * 32 * 15);
}

TEST_CASE("in the world of spheres the torus is in focus, and the camera meets no sphere") {
  const Scene scene = built_in("sphere-world");
  CHECK(std::fabs(coc_px(scene, depth_of(scene, scene.objects[1].position))) < 1.0);
  CHECK(coc_px(scene, 5.0) > 12.0);
  for (const Object& object : scene.objects) {
    if (object.mesh == scene.objects[2].mesh) {
      CHECK(object.position.y + object.scale.y + scene.camera.near_m < scene.camera.position.y);
    }
  }
}

TEST_CASE("a scene given by a directory of the user's comes first") {
  const TemporaryDirectory directory;
  write_file(directory.file("figures.toml"), "title = \"mine\"\n");
  write_file(directory.file("other.toml"), "title = \"other\"\n");
  const auto path = scene_search_path({directory.path()});
  CHECK(load_scene("figures", path).title == "mine");
  const auto listings = list_scenes(path);
  CHECK(std::is_sorted(listings.begin(), listings.end(),
                       [](const auto& a, const auto& b) { return a.name < b.name; }));
  CHECK(std::count_if(listings.begin(), listings.end(),
                      [](const auto& l) { return l.name == "figures"; }) == 1);
  CHECK(std::count_if(listings.begin(), listings.end(),
                      [](const auto& l) { return l.name == "other"; }) == 1);
}

TEST_CASE("a scene that cannot be read is listed as such") {
  const TemporaryDirectory directory;
  write_file(directory.file("broken.toml"), "title = \n");
  const auto listings = list_scenes({directory.path(), "/nowhere"});
  REQUIRE(listings.size() == 1);
  CHECK(contains(listings[0].title, "(cannot be read: "));
}

TEST_CASE("a title is read wherever it may stand before the tables, and of them alone") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("a.toml");
  const auto title_of = [&](const std::string& text) {
    write_file(file, text);
    return read_scene_title(file);
  };
  CHECK(title_of("background = [\n[0, 0, 0]]\ntitle = \"late\"\n[camera]\n") == "late");
  CHECK(title_of("note = \"\"\"\n[camera]\n\"\"\"\ntitle = \"later\"\n") == "later");
  CHECK(title_of("[camera]\ntitle = \"none\"\n").empty());
  CHECK(title_of("title = \"told\"\n[camera\n") == "told");
}

TEST_CASE("an unknown scene is answered with the names there are") {
  const std::string message = scene_error_of([] { built_in("forest"); });
  CHECK(
      contains(message, "there is no scene \"forest\"; there are bright-edges, canopy, clutter, "));
  CHECK(contains(scene_error_of([] { built_in("figure"); }), "did you mean 'figures'?"));
  CHECK(contains(scene_error_of([] { load_scene("x", {}); }), "no scenes were found at all"));
}

TEST_CASE("a path that ends in .toml or .obj is a file") {
  CHECK(scene_error_of([] { built_in("figures.toml"); }) ==
        "figures.toml: no such file; check the path");
  CHECK(contains(scene_error_of([] { built_in("THING.OBJ"); }), "THING.OBJ: no such file"));
}

TEST_CASE("a model of any size is seen whole, and near enough to see it") {
  for (const double size : {0.001, 1.0, 5000.0}) {
    CAPTURE(size);
    const Scene scene = model_scene(wedge(size));
    const CameraMatrices camera = camera_matrices(scene.camera, 0, 512, 512);
    double widest = 0.0;
    for (const glm::vec3& p : scene.meshes[0].positions) {
      const glm::dvec4 clip =
          camera.eye_to_clip * (camera.world_to_eye * glm::dvec4{glm::dvec3{p}, 1.0});
      widest = std::max({widest, std::fabs(clip.x / clip.w), std::fabs(clip.y / clip.w)});
      CHECK(std::fabs(clip.z / clip.w) < 1.0);
    }
    CHECK(widest == doctest::Approx(0.9).epsilon(1e-4));
  }
}

TEST_CASE("a model of any size is blurred alike") {
  for (const double size : {0.001, 1.0, 5000.0}) {
    CAPTURE(size);
    const Scene scene = model_scene(wedge(size));
    CHECK(lens_error(scene.lens.lens) == nullptr);
    double largest = 0.0;
    for (const glm::vec3& p : scene.meshes[0].positions) {
      largest = std::max(largest, std::fabs(coc_px(scene, depth_of(scene, glm::dvec3{p}))));
    }
    CHECK(largest == doctest::Approx(kModelCocPx).epsilon(0.001));
  }
}

TEST_CASE("the camera of a model is focused on what is in the middle of the picture") {
  // A wall at z = 0, pierced by nothing: the middle of the picture meets it.
  const Scene scene = model_scene("v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n");
  CHECK(scene.lens.lens.focus_m == doctest::Approx(depth_of(scene, {0, 0, 0})));
  // Two small plates with nothing between them: the middle of the box.
  const Scene apart = model_scene(
      "v -1 -1 0\nv -0.9 -1 0\nv -0.9 -0.9 0\nv 1 1 0\nv 0.9 1 0\nv 0.9 0.9 0\nf 1 2 3\nf 4 5 6\n");
  CHECK(apart.lens.lens.focus_m == doctest::Approx(depth_of(apart, {0, 0, 0})));
}

TEST_CASE("the worked example of docs/scene-format.md is a scene") {
  const std::string text = read_file(SOFTFOCUS_TEST_DATA "/../../docs/scene-format.md");
  const std::size_t start = text.find("```toml\n");
  REQUIRE(start != std::string::npos);
  const TemporaryDirectory directory;
  write_file(directory.file("example.toml"),
             text.substr(start + 8, text.find("```", start + 8) - start - 8));
  const Scene scene = load_scene(directory.file("example.toml"), {});
  CHECK(scene.objects.size() == 3);
  CHECK(std::fabs(coc_px(scene, depth_of(scene, scene.objects[1].position))) < 1.0);
}

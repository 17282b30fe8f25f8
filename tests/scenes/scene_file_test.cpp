#include "scenes/load/load_scene.h"

#include <doctest/doctest.h>

#include <string>

#include "scenes/draw/frame_matrices.h"
#include "scenes/make/backdrop.h"
#include "tests/support/scene_texts.h"

using namespace softfocus;
using namespace softfocus::test;

TEST_CASE("an empty file is a scene with the defaults of scene.h") {
  const Scene scene = read("");
  CHECK(scene.name == "a");
  CHECK(scene.title == "a");
  CHECK(scene.camera.fov_y_degrees == Camera{}.fov_y_degrees);
  CHECK(scene.camera.position == Camera{}.position);
  CHECK(scene.lens.lens.f_number == ThinLens{}.f_number);
  CHECK(scene.objects.empty());
}

TEST_CASE("top, camera and lens are read") {
  const Scene scene = read(R"(
title = "A title"
background = [0.1, 0.2, 0.3]
ambient_light = [1, 2, 3]
[camera]
position = [1, 2, 3]
target = [4, 5, 6]
up = [0, 0, 1]
fov_degrees = 50
near_m = 0.5
far_m = 50
orbit_degrees_per_frame = -2.5
[lens]
focal_length_mm = 85
f_number = 1.4
focus_m = 1.25
coc_scale = 2
max_coc_px = 12
)");
  CHECK(scene.title == "A title");
  CHECK(scene.background == glm::vec3{0.1f, 0.2f, 0.3f});
  CHECK(scene.ambient_light == glm::vec3{1.0f, 2.0f, 3.0f});
  CHECK(scene.camera.position == glm::dvec3{1, 2, 3});
  CHECK(scene.camera.target == glm::dvec3{4, 5, 6});
  CHECK(scene.camera.up == glm::dvec3{0, 0, 1});
  CHECK(scene.camera.fov_y_degrees == 50);
  CHECK(scene.camera.near_m == 0.5);
  CHECK(scene.camera.far_m == 50);
  CHECK(scene.camera.orbit_degrees_per_frame == -2.5);
  CHECK(scene.lens.lens.focal_length_mm == 85);
  CHECK(scene.lens.lens.f_number == 1.4);
  CHECK(scene.lens.lens.focus_m == 1.25);
  CHECK(scene.lens.coc_scale == 2);
  CHECK(scene.lens.max_coc_px_at_1024 == 12);
}

TEST_CASE("a lens may have its focus and f-number by frames") {
  const SceneLens lens =
      read("[lens]\nfocus_m = [[0, 2], [48, 6.5]]\nf_number = [[12, 4]]\nkeyframes = \"smooth\"\n")
          .lens;
  CHECK(lens.keys[&ThinLens::focus_m] == std::vector<Keyframe>{{0, 2}, {48, 6.5}});
  CHECK(lens.keys[&ThinLens::f_number] == std::vector<Keyframe>{{12, 4}});
  CHECK(lens.easing == Easing::smooth);
  CHECK(lens.lens.focus_m == 2);
  CHECK(lens.lens.f_number == 4);
  CHECK(read("[lens]\nfocus_m = [[0, 2]]\n").lens.easing == Easing::linear);
}

TEST_CASE("keys that cannot be are complaints with their line") {
  const auto of_focus = [](const std::string& keys) {
    return complaint("[lens]\nfocus_m = " + keys + "\n");
  };
  for (const char* keys : {"[[5, 2], [5, 3]]", "[[5, 2], [4, 3]]"}) {
    CHECK(contains(of_focus(keys), "a.toml:2: lens.focus_m: has frames that do not increase"));
  }
  CHECK(contains(of_focus("[[0, 2], [5, 0]]"), "a.toml:2: lens.focus_m: has a value out of range"));
  CHECK(contains(of_focus("[]"), "a.toml:2: lens.focus_m: is empty"));
  CHECK(contains(of_focus("[[0, 2], [5, 0.04]]"), "a.toml:2: lens.focus_m: "));
  for (const char* keys :
       {"[1, 2]", "[[1, 2, 3]]", "[[-1, 2]]", "[[0, \"a\"]]", "[[nan, 2]]", "[[2e9, 2]]"}) {
    CHECK(contains(of_focus(keys), "a.toml:2: lens.focus_m: "));
  }
  CHECK(contains(complaint("[lens]\nkeyframes = \"cubic\"\n"), "there are linear and smooth"));
}

TEST_CASE("lights are read, of both kinds") {
  const Scene scene = read(
      "[[light]]\nkind = \"directional\"\ndirection = [1, 2, 3]\n"
      "[[light]]\nkind = \"point\"\nposition = [4, 5, 6]\ncolour = [7, 8, 9]\n");
  REQUIRE(scene.lights.size() == 2);
  CHECK(scene.lights[0].kind == LightKind::directional);
  CHECK(scene.lights[0].position_or_direction == glm::vec3{1, 2, 3});
  CHECK(scene.lights[0].colour == glm::vec3{1.0f});
  CHECK(scene.lights[1].kind == LightKind::point);
  CHECK(scene.lights[1].position_or_direction == glm::vec3{4, 5, 6});
  CHECK(scene.lights[1].colour == glm::vec3{7, 8, 9});
}

TEST_CASE("a light's size, its shadows' darkness and where it ends are read") {
  const Scene scene = read(
      "light_points = 12\n"
      "[[light]]\nkind = \"directional\"\ndirection = [1, 2, 3]\nangular_radius_degrees = 0.5\n"
      "[[light]]\nkind = \"point\"\nposition = [4, 5, 6]\nradius_m = 0.25\n"
      "shadow_darkness = 0.75\nterminators = \"fade\"\n");
  CHECK(scene.light_points == 12);
  CHECK(scene.lights[0].angular_radius_degrees == 0.5);
  CHECK(scene.lights[0].shadow_darkness == 1.0f);
  CHECK(scene.lights[0].terminator == Terminator::facets);
  CHECK(scene.lights[1].radius_m == 0.25);
  CHECK(scene.lights[1].shadow_darkness == 0.75f);
  CHECK(scene.lights[1].terminator == Terminator::fade);
  CHECK(contains(complaint("light_points = 5000\n"), "a.toml:1: light_points: "));
  CHECK(contains(complaint("[[light]]\nkind = \"point\"\nposition = [4, 5, 6]\n"
                           "angular_radius_degrees = 1\n"),
                 "light.angular_radius_degrees: there is no such key"));
}

TEST_CASE("a colour may be a color, but not both") {
  const Scene scene = read(
      "[[light]]\nkind = \"point\"\nposition = [4, 5, 6]\ncolor = [7, 8, 9]\n"
      "[texture.t]\nkind = \"dots\"\nsize = 16\ncolors = [[1, 0, 0], [0, 0, 1]]\n");
  CHECK(scene.lights[0].colour == glm::vec3{7, 8, 9});
  CHECK(complaint("[[light]]\nkind = \"point\"\nposition = [4, 5, 6]\ncolour = [1, 1, 1]\n"
                  "color = [1, 1, 1]\n") ==
        "a.toml:5: light.color: is there as colour too; one of them would be right");
  CHECK(contains(complaint("[[light]]\nkind = \"point\"\nposition = [4, 5, 6]\n\ncolor = 7\n"),
                 "a.toml:5: light.colour: is a number"));
  CHECK(contains(complaint("[lens]\ncolor = 7\n"), "a.toml:2: lens.color: there is no such key"));
}

TEST_CASE("a material has what its table says, and ambient like diffuse if it says nothing") {
  const Scene scene = read(R"(
[texture.t]
kind = "checker"
size = 16
cells = 2
colours = [[1, 0, 0], [0, 0, 1]]
filter = "nearest"
wrap = "mirrored_repeat"
[material.a]
diffuse = [0.1, 0.2, 0.3]
[material.b]
ambient = [0.4, 0.5, 0.6]
specular = [0.7, 0.8, 0.9]
shininess = 100
texture = "t"
two_sided = true
lit = false
[[object]]
shape = "cube"
material = "b"
)");
  REQUIRE(scene.materials.size() == 2);
  CHECK(scene.materials[0].ambient == glm::vec3{0.1f, 0.2f, 0.3f});
  CHECK_FALSE(scene.materials[0].texture);
  CHECK_FALSE(scene.materials[0].two_sided);
  CHECK(scene.materials[0].lit);
  const Material& b = scene.materials[1];
  CHECK(b.ambient == glm::vec3{0.4f, 0.5f, 0.6f});
  CHECK(b.specular == glm::vec3{0.7f, 0.8f, 0.9f});
  CHECK(b.shininess == 100);
  CHECK(b.texture == 0u);
  CHECK(b.sampler.filter == Filter::nearest);
  CHECK(b.sampler.wrap_v == Wrap::mirrored_repeat);
  CHECK(b.two_sided);
  CHECK_FALSE(b.lit);
  CHECK(scene.textures[0].levels.size() == 5);
}

TEST_CASE("every shape can be asked for, with nothing but its name") {
  for (const char* shape : {"sphere", "torus", "cone", "cube", "plane", "teapot"}) {
    CAPTURE(shape);
    const Scene scene = read(object("shape = \"" + std::string(shape) + "\"\n"));
    REQUIRE(scene.meshes.size() == 1);
    CHECK(scene.meshes[0].indices.size() > 100);
    CHECK(scene.objects[0].scale == glm::dvec3{1.0});
  }
}

TEST_CASE("a camera may be on its way, by frames") {
  const Scene scene = read(
      "[camera]\nposition = [[0, 0, 1, 5], [10, 2, 1, 3]]\ntarget = [0, 1, 0]\n"
      "keyframes = \"linear\"\n");
  CHECK(scene.camera.position == glm::dvec3{0.0, 1.0, 5.0});
  CHECK(camera_matrices(scene.camera, 5.0, 64, 64).eye == glm::dvec3{1.0, 1.0, 4.0});
  CHECK(camera_matrices(scene.camera, 50.0, 64, 64).eye == glm::dvec3{2.0, 1.0, 3.0});
  CHECK(moves(scene.camera));
  const Scene looks =
      read("[camera]\nposition = [0, 0, 3]\ntarget = [[0, 0, 0, 0], [8, 4, 0, 0]]\n");
  CHECK(target_at(looks.camera, 2.0) == glm::dvec3{1.0, 0.0, 0.0});
}

TEST_CASE("a camera cannot look where its way meets its target, nor along up") {
  const Scene through = read("[camera]\nposition = [[0, 0, 0, 5], [10, 0, 0, -5]]\n");
  CHECK(can_look(through.camera, 0.0));
  CHECK(can_look(through.camera, 4.0));
  CHECK_FALSE(can_look(through.camera, 5.0));
  const Scene over = read("[camera]\nposition = [[0, 0, 6, 6], [10, 0, 6, -6]]\n");
  CHECK(can_look(over.camera, 4.0));
  CHECK_FALSE(can_look(over.camera, 5.0));
}

TEST_CASE("a camera's way that cannot be is a complaint") {
  CHECK(complaint("[camera]\nposition = [[5, 0, 1, 5], [5, 2, 1, 3]]\n") ==
        "a.toml:2: camera.position: has frames that do not increase from 0 on; [[0, 0, 1, 5], "
        "[90, 0, 1, 2]] would be right");
  CHECK(contains(complaint("[camera]\nposition = [[0, 0, 1], [5, 2, 1]]\n"), "camera.position"));
  CHECK(contains(complaint("[camera]\nposition = [[0, 0, 1, 2e7]]\n"), "out of range"));
  CHECK(contains(complaint("[camera]\nposition = [[0, 0, 0, 5], [9, 0, 0, 0]]\n"
                           "target = [0, 0, 0]\n"),
                 "is the camera's position"));
}

TEST_CASE("an object may be an impostor, within a budget") {
  const std::string sphere = "shape = \"sphere\"\n";
  CHECK(read(object(sphere)).objects[0].impostor == ImpostorUse::never);
  CHECK(read(object(sphere + "impostor = true\n")).objects[0].impostor ==
        ImpostorUse::wherever_possible);
  const Scene scene = read("[impostors]\ntolerance_px = 2\nmemory_mb = 64\nmilliseconds = 20\n" +
                           object(sphere + "impostor = \"auto\"\n"));
  CHECK(scene.objects[0].impostor == ImpostorUse::where_cheaper);
  CHECK(scene.impostors.tolerance_px == 2.0);
  CHECK(scene.impostors.memory_mb == 64.0);
  CHECK(scene.impostors.milliseconds == 20.0);
  CHECK(contains(complaint(object(sphere + "impostor = \"never\"\n")),
                 "object.impostor: is none of true, false and \"auto\""));
  CHECK(contains(complaint(object(sphere + "impostor = true\nsway = [1, 0, 0]\n")),
                 "is of an object that moves"));
}

TEST_CASE("a backdrop moves away from the eye and grows, and what is before it stays") {
  const std::string cube = "[[object]]\nmaterial = \"m\"\nshape = \"cube\"\n";
  const std::string objects = std::string{kMaterial} + cube + "position = [0, 1, 0]\n" + cube +
                              "position = [3, 1, -4]\nscale = [1, 2, 3]\nsway = [1, 0, 0]\n" +
                              cube + "position = [0, 1, -9]\n";
  const std::string section = "[backdrop]\neye = [0, 1, 0.5]\nbeyond_m = 2\n";
  CHECK_FALSE(backdrop_distance_m(read(objects)));
  Scene scene = read(section + objects);
  const Scene before = scene;
  const double distance_m = std::sqrt(9.0 + 20.25);
  CHECK(backdrop_distance_m(scene).value() == distance_m);
  set_backdrop(scene, 2.0 * distance_m);
  CHECK(backdrop_distance_m(scene).value() == doctest::Approx(2.0 * distance_m));
  CHECK(scene.objects[0].position == before.objects[0].position);
  CHECK(scene.objects[0].scale == before.objects[0].scale);
  CHECK(scene.objects[1].position == glm::dvec3{6, 1, -8.5});
  CHECK(scene.objects[1].scale == glm::dvec3{2, 4, 6});
  CHECK(scene.objects[1].sway == glm::dvec3{2, 0, 0});
  CHECK(scene.objects[2].position == glm::dvec3{0, 1, -18.5});
  CHECK(scene.camera.far_m == 2.0 * before.camera.far_m);
  set_backdrop(scene, distance_m);
  CHECK(scene.objects[1].position == glm::dvec3{3, 1, -4});
  CHECK(scene.camera.far_m == 2.0 * before.camera.far_m);

  CHECK(complaint("[backdrop]\neye = [0, 0, 0]\n" + objects) ==
        "a.toml:1: backdrop.beyond_m: is missing; docs/scene-format.md has both keys");
  CHECK(contains(complaint("[backdrop]\neye = [0, 0, 0]\nbeyond_m = 40\n" + objects),
                 "a.toml:3: backdrop.beyond_m: leaves no object"));
}

TEST_CASE("an object stands and moves as its table says") {
  const Scene scene = read(object(R"(
shape = "cube"
size = 2
cells = 3
position = [1, 2, 3]
rotation_degrees = [4, 5, 6]
scale = [7, 8, 9]
spin_degrees_per_frame = [1, 0, -1]
sway = [0, 0, 0.5]
sway_period_frames = 90
sway_phase = 0.25
)"));
  const Object& o = scene.objects[0];
  CHECK(o.position == glm::dvec3{1, 2, 3});
  CHECK(o.rotation_degrees == glm::dvec3{4, 5, 6});
  CHECK(o.scale == glm::dvec3{7, 8, 9});
  CHECK(o.spin_degrees_per_frame == glm::dvec3{1, 0, -1});
  CHECK(o.sway == glm::dvec3{0, 0, 0.5});
  CHECK(o.sway_period_frames == 90);
  CHECK(o.sway_phase == 0.25);
  CHECK(scene.meshes[0].indices.size() == 3 * 12 * 9);
  CHECK(read(object("shape = \"cube\"\nscale = 2\n")).objects[0].scale == glm::dvec3{2.0});
}

TEST_CASE("a material may have an opacity, and a texture for it") {
  const Scene scene = read(
      "[texture.holes]\nkind = \"dots\"\nwrap = \"clamp_to_edge\"\n"
      "colours = [[1, 1, 1], [0, 0, 0]]\n"
      "[material.a]\n[material.b]\nopacity = 0.25\nopacity_texture = \"holes\"\n"
      "[material.c]\nopacity_texture = \"holes\"\n"
      "[material.d]\nopacity_texture = \"holes\"\ncut_out = true\n"
      "[[object]]\nshape = \"cube\"\nmaterial = \"b\"\n");
  REQUIRE(scene.textures.size() == 2);
  CHECK(scene.materials[0].opacity == 1.0f);
  CHECK_FALSE(scene.materials[0].opacity_texture);
  CHECK(scene.materials[1].opacity == 0.25f);
  CHECK(scene.materials[1].opacity_texture == 1u);
  CHECK(scene.materials[1].opacity_sampler.wrap_u == Wrap::clamp_to_edge);
  CHECK(scene.materials[2].opacity_texture == 1u);
  CHECK_FALSE(scene.materials[2].cut_out);  // its dots have soft edges
  CHECK(scene.materials[3].cut_out);
}

TEST_CASE("an opacity texture of 0 and 1 alone makes a cut-out, unless the scene says otherwise") {
  const TemporaryDirectory directory;
  write_file(directory.file("mask.png"), mask_bytes());
  write_file(directory.file("a.toml"),
             "[texture.mask]\nfile = \"mask.png\"\n[material.a]\nopacity_texture = \"mask\"\n"
             "[material.b]\nopacity_texture = \"mask\"\ncut_out = false\n[[object]]\n"
             "shape = \"cube\"\nmaterial = \"a\"\n");
  const Scene scene = read_scene_file(directory.file("a.toml"));
  CHECK(scene.materials[0].cut_out);
  CHECK_FALSE(scene.materials[1].cut_out);
}

TEST_CASE("an object may be inside out, and its texture repeat") {
  const Scene scene =
      read(object("shape = \"plane\"\ninside_out = true\ntexture_repeat = [3, 4]\n"));
  CHECK(scene.meshes[0].normals[0] == glm::vec3{0, -1, 0});
  float largest = 0.0f;
  for (const glm::vec2& uv : scene.meshes[0].uvs) largest = std::max(largest, uv.y);
  CHECK(largest == 4.0f);
}

TEST_CASE("a scatter gives as many objects as it says, of one mesh and the materials named") {
  const Scene scene = read(
      "[material.a]\n[material.b]\n[[scatter]]\nshape = \"sphere\"\nradius = 0.5\n"
      "materials = [\"a\", \"b\"]\ncount = 40\nregion_min = [-9, 0, -9]\n"
      "region_max = [9, 0, 9]\nscale_range = [0.5, 1]\non_ground = true\nturned = true\n");
  CHECK(scene.meshes.size() == 1);
  REQUIRE(scene.objects.size() == 40);
  int of_a = 0;
  for (const Object& o : scene.objects) {
    if (o.material == 0) ++of_a;
    CHECK(o.position.y == doctest::Approx(o.scale.x * 0.5));
    CHECK(o.scale.x >= 0.49999);
    CHECK(o.scale.x <= 1.00001);
    CHECK(o.rotation_degrees != glm::dvec3{0.0});
  }
  CHECK(of_a > 5);
  CHECK(of_a < 35);
}

TEST_CASE("scatters keep clear of what they avoid and of one another") {
  const std::string both =
      scatter_of("count = 1\nregion_min = [0, 0, 0]\nregion_max = [0, 0, 0]\n") +
      "[[scatter]]\nshape = \"sphere\"\nmaterials = [\"m\"]\n";
  CHECK(contains(complaint(both + "region_min = [0.5, 0, 0]\nregion_max = [0.6, 0, 0]\n"),
                 "a.toml:8: scatter.count: there is no room"));
  CHECK(read(both + "region_min = [2.5, 0, 0]\nregion_max = [2.6, 0, 0]\n").objects.size() == 2);
  CHECK(contains(complaint(scatter_of("region_min = [0, 0, 0]\nregion_max = [1, 1, 1]\n"
                                      "avoid = [[0, 0, 0, 5]]\n")),
                 "scatter.count: there is no room"));
}

TEST_CASE("a texture and a model may come from files beside the scene") {
  const TemporaryDirectory directory;
  write_file(directory.file("wood.png"), png_bytes(8, 8));
  write_file(directory.file("thing.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl x\nf 1 2 3\n");
  write_file(directory.file("s.toml"),
             "[texture.wood]\nfile = \"wood.png\"\n[material.m]\ntexture = \"wood\"\n"
             "[[object]]\nshape = \"model\"\nfile = \"thing.obj\"\nscale = 3\n"
             "[[object]]\nshape = \"model\"\nfile = \"thing.obj\"\nmaterial = \"m\"\n");
  write_file(directory.file("twice.toml"),
             "[[object]]\nshape = \"model\"\nfile = \"thing.obj\"\n"
             "[[object]]\nshape = \"model\"\nfile = \"thing.obj\"\nposition = [1, 2, 3]\n");
  const Scene twice = read_scene_file(directory.file("twice.toml"));
  CHECK(twice.meshes.size() == 1);
  REQUIRE(twice.objects.size() == 2);
  CHECK(twice.objects[1].mesh == 0);
  CHECK(twice.objects[1].material == twice.objects[0].material);
  CHECK(twice.objects[1].position == glm::dvec3{1.0, 2.0, 3.0});
  const Scene scene = read_scene_file(directory.file("s.toml"));
  CHECK(scene.name == "s");
  REQUIRE(scene.objects.size() == 2);
  CHECK(scene.textures[0].levels[0].format == Format::srgb8);
  CHECK(scene.objects[0].scale == glm::dvec3{3.0});
  CHECK(scene.materials[scene.objects[0].material].name == "neutral grey");
  CHECK(scene.materials[scene.objects[1].material].name == "m");
  CHECK(scene.warnings.size() == 2);
}

// Faults of a scene's file, and how they are told.

#include <doctest/doctest.h>

#include <string>

#include "scenes/load/load_scene.h"
#include "tests/support/scene_texts.h"

using namespace softfocus;
using namespace softfocus::test;

TEST_CASE("what is no TOML is a complaint with the line") {
  CHECK(contains(complaint("title = \"x\"\nbackground = [0, 0\n[camera]\n"),
                 "a.toml:3: is no TOML: "));
  CHECK(contains(complaint("title = \"x\"\ntitle = \"y\"\n"), "a.toml:2: is no TOML: "));
}

TEST_CASE("a key of too many parts is an error with its line, and dots in texts are none") {
  std::string key = "a";
  for (int i = 0; i < 5000; ++i) key += ".a";
  const std::string wanted = "a key has more than 64 parts; fewer would be right";
  CHECK(complaint("[" + key + "]\n") == "a.toml:1: " + wanted);
  CHECK(complaint("title = \"x\"\n" + key + " = 1\n") == "a.toml:2: " + wanted);
  CHECK(complaint("title = \"\"\"\n\n\"\"\"\nx = {" + key + " = 1}\n") == "a.toml:4: " + wanted);
  const std::string dots(100, '.');
  CHECK(read_scene_text("title = \"" + dots + "\" # " + dots + "\n", "a.toml").title == dots);
}

TEST_CASE("every unknown key is an error that names the line and the keys there are") {
  CHECK(complaint("title = \"x\"\ntitel = \"y\"\n") ==
        "a.toml:2: titel: there is no such key; here are title, background, ambient_light, "
        "camera, lens, light_points, light, effect, texture, material, impostors, object, "
        "scatter and backdrop; did you mean 'title'?");
  CHECK(contains(complaint("mm = 1\nzz = 2\naa = 3\n"), "a.toml:1: mm: there is no such key"));
  CHECK(complaint("[lens]\nfocus_m = 2\nfocus = 3\n") ==
        "a.toml:3: lens.focus: there is no such key; here are focus_m, focal_length_mm, "
        "f_number, keyframes, coc_scale and max_coc_px; did you mean 'focus_m'?");
  for (const std::string& text :
       {std::string("[camera]\nxyz = 1\n"), std::string("[material.m]\nxyz = 1\n"),
        std::string("[texture.t]\nkind = \"dots\"\nxyz = 1\ncolours = [[0, 0, 0], [1, 1, 1]]\n"),
        std::string("[[light]]\nkind = \"point\"\nposition = [0, 0, 0]\nxyz = 1\n"),
        object("shape = \"cube\"\nxyz = 1\n"), scatter_of("xyz = 1\n"),
        object("shape = \"sphere\"\nheight = 1\n")}) {
    CHECK(contains(complaint(text), ": there is no such key; here are "));
  }
}

TEST_CASE("a value of the wrong type is an error") {
  CHECK(complaint("title = 3\n") ==
        "a.toml:1: title: is a number; a text in quotes would be right");
  CHECK(complaint("camera = 3\n") ==
        "a.toml:1: camera: is a number; a table [camera] would be right");
  CHECK(complaint("light = 3\n") ==
        "a.toml:1: light: is a number; tables [[light]] would be right");
  CHECK(
      complaint("[camera]\n\nfov_degrees = \"wide\"\n") ==
      "a.toml:3: camera.fov_degrees: is a text; a number from 0.001 to 179.999 (degrees) would be "
      "right");
  CHECK(complaint("[material.m]\nlit = 1\n") ==
        "a.toml:2: material.m.lit: is a number; true or false would be right");
  CHECK(complaint("[material.m]\nshininess = 2.5\n") ==
        "a.toml:2: material.m.shininess: has a fraction; a whole number from 1 to 1024 would be "
        "right");
  CHECK(complaint("background = [0, 1]\n") ==
        "a.toml:1: background: has 2 values; an array of 3 numbers from 0 to 1000 would be right");
  CHECK(
      contains(complaint("background = [0, 1, true]\n"), "a.toml:1: background: is true or false"));
  CHECK(contains(complaint("background = 0.5\n"), "a.toml:1: background: is a number; an array"));
  CHECK(contains(complaint("material = 1\n"), "a.toml:1: material: is a number"));
  CHECK(contains(complaint("[material]\nm = 1\n"), "a.toml:2: material.m: is a number"));
}

TEST_CASE("a value out of its range is an error, NaN and infinity too") {
  CHECK(
      complaint("[camera]\nfov_degrees = 180\n") ==
      "a.toml:2: camera.fov_degrees: 180 is out of range; a number from 0.001 to 179.999 (degrees) "
      "would be right");
  for (const char* value : {"nan", "-nan", "inf", "-inf", "1e300", "-1", "0"}) {
    CHECK(contains(complaint(std::string("[camera]\nnear_m = ") + value + "\n"),
                   "a.toml:2: camera.near_m: "));
    CHECK(contains(complaint(std::string("[lens]\nf_number = ") + value + "\n"),
                   "a.toml:2: lens.f_number: "));
  }
  CHECK(contains(complaint("background = [0, nan, 0]\n"), "out of range"));
  CHECK(contains(complaint("background = [0, -1, 0]\n"), "out of range"));
}

TEST_CASE("values that do not go together are errors") {
  CHECK(complaint("[camera]\nnear_m = 5\nfar_m = 5\n") ==
        "a.toml:3: camera.far_m: must be larger than near_m");
  CHECK(contains(complaint("[camera]\nposition = [1, 1, 1]\ntarget = [1, 1, 1]\n"),
                 "a.toml:3: camera.target: is the camera's position"));
  CHECK(
      contains(complaint("[camera]\nposition = [0, 5, 0]\n"), "camera.up: points along the view"));
  CHECK(contains(complaint("[camera]\nup = [0, 0, 0]\n"), "a.toml:2: camera.up: "));
  CHECK(contains(complaint("[lens]\nfocal_length_mm = 900\nfocus_m = 0.5\n"),
                 "a.toml:3: lens.focus_m: the focal length must be shorter"));
  CHECK(contains(complaint(object("shape = \"torus\"\ntube_radius = 1\n")),
                 "a.toml:5: object.tube_radius: must be smaller than ring_radius"));
  CHECK(contains(complaint(scatter_of("region_min = [2, 0, 0]\n")),
                 "a.toml:5: scatter.region_min: must not exceed"));
  CHECK(contains(complaint(scatter_of("scale_range = [2, 1]\n")),
                 "a.toml:5: scatter.scale_range: must have the smaller number first"));
}

TEST_CASE("a light needs its kind, and a place or a direction") {
  CHECK(contains(complaint("[[light]]\ncolour = [1, 1, 1]\n"), "a.toml:1: light.kind: is missing"));
  CHECK(complaint("[[light]]\nkind = \"spot\"\n") ==
        "a.toml:2: light.kind: there is no \"spot\"; there are directional and point");
  CHECK(contains(complaint("[[light]]\nkind = \"point\"\n"), "light.position: is missing"));
  CHECK(contains(complaint("[[light]]\nkind = \"directional\"\ndirection = [0, 0, 0]\n"),
                 "a.toml:3: light.direction: points nowhere"));
  CHECK(contains(complaint("[[light]]\nkind = \"point\"\nposition = [0, 0, 0]\n"
                           "direction = [0, 1, 0]\n"),
                 "light.direction: there is no such key"));
}

TEST_CASE("a name that refers to nothing is an error") {
  CHECK(complaint("[[object]]\nshape = \"cube\"\nmaterial = \"gold\"\n") ==
        "a.toml:3: object.material: there is no material \"gold\"; a table [material.gold] would "
        "be right");
  CHECK(complaint("[material.m]\ntexture = \"wood\"\n") ==
        "a.toml:2: material.m.texture: there is no texture \"wood\"; a table [texture.wood] would "
        "be right");
  CHECK(contains(complaint("[[object]]\nshape = \"cube\"\n"),
                 "a.toml:1: object.material: is missing"));
  CHECK(contains(complaint("[[scatter]]\nshape = \"cube\"\n"),
                 "a.toml:1: scatter.materials: is missing"));
}

TEST_CASE("a shape that is missing or unknown is an error that names those there are") {
  CHECK(complaint(object("")) ==
        "a.toml:2: object.shape: is missing; there are sphere, torus, cone, cube, plane, teapot "
        "and model");
  CHECK(complaint(object("shape = \"ball\"\n")) ==
        "a.toml:4: object.shape: there is no \"ball\"; there are sphere, torus, cone, cube, plane, "
        "teapot and model");
  CHECK(contains(complaint("[material.m]\n[[scatter]]\nshape = \"model\"\n"),
                 "scatter.shape: a model cannot be used here"));
  CHECK(contains(complaint(object("shape = \"model\"\n")), "object.file: is missing"));
}

TEST_CASE("an opacity is 0 to 1, and its texture is there") {
  CHECK(contains(complaint("[material.m]\nopacity = 1.5\n"), "a.toml:2: material.m.opacity: "));
  CHECK(contains(complaint("[material.m]\nopacity = \"glass\"\n"), "material.m.opacity: "));
  CHECK(complaint("[material.m]\ncut_out = true\n") ==
        "a.toml:2: material.m.cut_out: nothing says where; an `opacity_texture` would");
  CHECK(complaint("[material.m]\nopacity_texture = \"leaf\"\n") ==
        "a.toml:2: material.m.opacity_texture: there is no texture \"leaf\"; a table "
        "[texture.leaf] would be right");
}

TEST_CASE("a texture is made by formula or read from a file") {
  CHECK(contains(complaint("[texture.t]\n"), "a.toml:1: texture.t: a texture has either"));
  CHECK(contains(complaint("[texture.t]\nkind = \"dots\"\nfile = \"x.png\"\n"),
                 "texture.t.file: a texture has either"));
  CHECK(contains(complaint("[texture.t]\nfile = \"none.png\"\n[material.m]\ntexture = \"t\"\n"
                           "[[object]]\nmaterial = \"m\"\n"),
                 "none.png: no such file"));
  CHECK(contains(
      complaint("[texture.t]\nfile = \"none.png\"\nfilter = \"cubic\"\n"),
      "texture.t.filter: there is no \"cubic\"; there are nearest, bilinear and trilinear"));
  CHECK(contains(complaint("[texture.t]\nkind = \"plaid\"\n"),
                 "texture.t.kind: there is no \"plaid\"; there are checker, stripes"));
  CHECK(complaint("[texture.t]\nkind = \"dots\"\nsize = 100\n") ==
        "a.toml:3: texture.t.size: 100 is no power of two; 64 or 128 would be right");
  CHECK(complaint("[texture.t]\nkind = \"dots\"\nsize = 16\ncolours = [[0, 0, 0]]\n") ==
        "a.toml:4: texture.t.colours: 1 are given; the pattern \"dots\" needs 2 (ground, dot), "
        "each [red, green, blue] from 0 to 1");
}

TEST_CASE("absurd sizes are errors before any memory is taken for them") {
  for (const std::string& text :
       {object("shape = \"sphere\"\nsegments = 1000000000\n"),
        object("shape = \"sphere\"\nrings = 99999999999999\n"),
        object("shape = \"teapot\"\ndivisions = 100000\n"),
        object("shape = \"cube\"\ncells = 100000\n"),
        object("shape = \"plane\"\ncells_x = 100000\n"), object("shape = \"cone\"\nsegments = 2\n"),
        scatter_of("count = 1000000000\n"), scatter_of("count = 0\n"),
        object("shape = \"cube\"\nscale = 0\n"), object("shape = \"cube\"\nscale = [1, 0, 1]\n"),
        object("shape = \"cube\"\nposition = [1e30, 0, 0]\n"),
        object("shape = \"cube\"\nsway_period_frames = 0\n"),
        std::string("[texture.t]\nkind = \"dots\"\nsize = 1048576\n")}) {
    CHECK(contains(complaint(text), "is out of range; "));
  }
  std::string many;
  for (int i = 0; i < 65; ++i) many += "[[light]]\nkind = \"point\"\nposition = [0, 0, 0]\n";
  CHECK(contains(complaint(many), "light: has 65 lights; up to 64 would do"));
}

TEST_CASE("more triangles than a scene may have are an error that names the object") {
  std::string text{kMaterial};
  for (int i = 0; i < 20; ++i) {
    text += "[[object]]\nmaterial = \"m\"\nshape = \"sphere\"\nsegments = 1024\nrings = 1024\n";
  }
  const std::string said = complaint(text);
  CHECK(said.starts_with("a.toml:"));
  CHECK(said.find("fewer segments") != said.npos);
}

TEST_CASE("a texture that no object shows is checked, but neither made nor loaded") {
  const std::string unused =
      "[texture.t]\nfile = \"missing.png\"\n[material.n]\ntexture = \"t\"\n" +
      object("shape = \"cube\"\n");
  const Scene scene = read(unused);
  CHECK(scene.textures.empty());
  CHECK(scene.files.size() == 1);
  CHECK(complaint("[texture.t]\nfiel = \"missing.png\"\n") != "");
  CHECK(complaint("[texture.t]\nfile = \"missing.png\"\n[material.m]\ntexture = \"t\"\n"
                  "[[object]]\nmaterial = \"m\"\nshape = \"cube\"\n")
            .find("missing.png") != std::string::npos);
}

TEST_CASE("a name with a line end or a terminal sequence in it cannot spoil the complaint") {
  CHECK(contains(complaint("\"a\\nb\\u001b[31m\" = 1\n"),
                 "a.toml:1: a?b?[31m: there is no such key"));
}

TEST_CASE("a bracket at a line's end is no TOML, and no end of the program") {
  CHECK(contains(complaint("[\n"), "a.toml:1: is no TOML: "));
}

TEST_CASE("damaged text gives a complaint of one line or a scene, and nothing else") {
  const std::string whole = scatter_of(
      "count = 3\nregion_max = [5, 5, 5]\n[camera]\nfov_degrees = 40\n[lens]\nfocus_m = 1.5\n");
  for (std::size_t i = 0; i < whole.size(); ++i) {
    for (const char damage : {'-', '9', ' ', '"', ']', '.', '\n'}) {
      std::string text = whole;
      text[i] = damage;
      CHECK_UNARY(complaint(text).find('\n') == std::string::npos);
    }
  }
}

TEST_CASE("letters beyond ASCII stand in texts, and nowhere else") {
  CHECK(read("title = \"\"\"\\\n  \u00e9t\u00e9\"\"\"\n").title == "\u00e9t\u00e9");
  for (const char* letter : {"\u00e9", "\u00a0", "\u2028", "\u3042"}) {
    const std::string text = std::string{"\ntitle = ["} + letter + "]\n";
    CHECK(complaint(text).starts_with("a.toml:2: is no TOML"));
  }
}

#include "scenes/models/mtl_file.h"

#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "scenes/models/obj_model.h"
#include "tests/support/scene_test_files.h"

using namespace softfocus;
using namespace softfocus::test;

namespace {

// The model of a text, and of its library.
Model load_with_library(std::string_view obj, std::string_view mtl = "") {
  const TemporaryDirectory directory;
  write_file(directory.file("a.obj"), obj);
  if (!mtl.empty()) write_file(directory.file("a.mtl"), mtl);
  write_file(directory.file("wood.png"), png_bytes(4, 4));
  return load_obj_model(directory.file("a.obj"));
}

std::string triangle_and(std::string_view lines) {
  return "v 0 0 0\nv 1 0 0\nv 0 1 0\n" + std::string(lines);
}

}  // namespace

TEST_CASE("Ka, Kd, Ks and Ns are read, Ns as a whole number") {
  const Model model = load_with_library(
      triangle_and("mtllib a.mtl\nusemtl a\nf 1 2 3\n"),
      "newmtl a\nKa 0.1 0.2 0.3\nKd 0.4 0.5 0.6\nKs 0.7 0.8 0.9\nNs 96.6\nd 0.5\nillum 2\n");
  const Material& material = model.materials[model.parts[0].material];
  CHECK(material.ambient == glm::vec3{0.1f, 0.2f, 0.3f});
  CHECK(material.diffuse == glm::vec3{0.4f, 0.5f, 0.6f});
  CHECK(material.specular == glm::vec3{0.7f, 0.8f, 0.9f});
  CHECK(material.shininess == 97);
  CHECK(material.two_sided);
}

TEST_CASE("Ns is kept from 1 to 1024") {
  for (const auto& [written, kept] : {std::pair{"-5", 1}, {"0", 1}, {"1e9", 1024}, {"nan", 1}}) {
    const Model model = load_with_library(triangle_and("mtllib a.mtl\nusemtl a\nf 1 2 3\n"),
                                          std::string("newmtl a\nKd 1 1 1\nNs ") + written + "\n");
    CHECK(model.materials[0].shininess == kept);
  }
}

TEST_CASE("a Ka that is black or white means nothing") {
  for (const char* ka : {"", "Ka 0 0 0\n", "Ka 1 1 1\n"}) {
    const Model model = load_with_library(triangle_and("mtllib a.mtl\nusemtl a\nf 1 2 3\n"),
                                          std::string("newmtl a\nKd 0.4 0.5 0.6\n") + ka);
    CHECK(model.materials[0].ambient == glm::vec3{0.4f, 0.5f, 0.6f});
  }
}

TEST_CASE("a texture is loaded once, however many materials have it") {
  const Model model = load_with_library(
      triangle_and("v 0 0 1\nmtllib a.mtl\nusemtl a\nf 1 2 3\nusemtl b\nf 1 2 4\n"),
      "newmtl a\nKd 1 1 1\nmap_Kd wood.png\nnewmtl b\nKd 1 1 1\nmap_Kd ./wood.png\n");
  CHECK(model.textures.size() == 1);
  CHECK(model.materials[0].texture == 0u);
  CHECK(model.materials[1].texture == 0u);
}

TEST_CASE("a texture is found by its last part, and a black Kd does not hide it") {
  const Model model = load_with_library(triangle_and("mtllib a.mtl\nusemtl a\nf 1 2 3\n"),
                                        "newmtl a\nKd 0 0 0\nmap_Kd C:\\Users\\me\\wood.png\n");
  CHECK(model.textures.size() == 1);
  CHECK(model.materials[0].diffuse == glm::vec3{1.0f});
  CHECK(model.warnings.empty());
}

TEST_CASE("a clamped texture is clamped") {
  const Model model = load_with_library(triangle_and("mtllib a.mtl\nusemtl a\nf 1 2 3\n"),
                                        "newmtl a\nKd 1 1 1\nmap_Kd -clamp on wood.png\n");
  CHECK(model.materials[0].sampler.wrap_u == Wrap::clamp_to_edge);
}

TEST_CASE("d is an opacity from 0 to 1, Tr is 1 - d, and d wins") {
  const std::string obj = triangle_and("mtllib a.mtl\nusemtl a\nf 1 2 3\n");
  struct Case {
    std::string written;
    float opacity;
  };
  for (const Case& one : {Case{"", 1.0f},
                          {"d 0.25", 0.25f},
                          {"Tr 0.25", 0.75f},
                          {"d 0.25\nTr 0.25", 0.25f},
                          {"Tr 0.25\nd 0.25", 0.25f},
                          {"d -halo 0.25", 0.25f},
                          {"d -1", 1.0f},
                          {"d nan", 1.0f},
                          {"d 7", 1.0f},
                          {"Tr 1", 1.0f},
                          {"Tr 7", 1.0f},
                          {"d 0\nTr 1", 1.0f},  // or nothing would show
                          {"D 0.25", 0.25f}}) {
    const std::string& written = one.written;
    CAPTURE(written);
    const Model model = load_with_library(obj, "newmtl a\nKd 1 1 1\n" + written + "\n");
    CHECK(model.materials[0].opacity == one.opacity);
    CHECK_FALSE(model.materials[0].opacity_texture);
  }
}

TEST_CASE(
    "what makes a material invisible stays where others show, and is told where it does not") {
  const std::string obj =
      triangle_and("v 0 0 1\nmtllib a.mtl\nusemtl a\nf 1 2 3\nusemtl b\nf 1 2 4\n");
  const Model glass = load_with_library(obj, "newmtl a\nKd 1 1 1\nd 0\nnewmtl b\nKd 1 1 1\n");
  CHECK(glass.materials[0].opacity == 0.0f);
  const Model hidden = load_with_library(obj, "newmtl a\nd 0\nnewmtl b\nTr 1\n");
  CHECK(hidden.materials[0].opacity == 0.0f);
  REQUIRE(hidden.warnings.size() >= 1);
  CHECK(contains(hidden.warnings.back(), "material b: Tr 1 without d"));
}

TEST_CASE("colours are one number or three; what is none is told") {
  struct Case {
    std::string written;
    glm::vec3 diffuse;
    bool warns;
  };
  for (const Case& one : {Case{"Kd 0.5", glm::vec3{0.5f}, false},
                          {"KD 0.5 0.25 1", {0.5f, 0.25f, 1.0f}, false},
                          {"Kd spectral a.rfl 1.0", glm::vec3{0.5f}, true},
                          {"Kd xyz 0.1 0.2 0.3", glm::vec3{0.5f}, true},
                          {"Kd nan 1 1", {0.0f, 1.0f, 1.0f}, true},
                          {"Kd -5 0.5 0.5", {0.0f, 0.5f, 0.5f}, true},
                          {"Kd red", glm::vec3{0.0f}, true}}) {
    CAPTURE(one.written);
    const Model model = load_with_library(triangle_and("mtllib a.mtl\nusemtl a\nf 1 2 3\n"),
                                          "newmtl a\n" + one.written + "\n");
    CHECK(model.materials[0].diffuse == one.diffuse);
    CHECK(model.warnings.empty() != one.warns);
  }
}

TEST_CASE("Ns 0 is no highlight") {
  for (const auto& [written, shines] :
       {std::pair{"Ns 0\n", false}, {"Ns nan\n", true}, {"Ns 0.5\n", true}, {"", true}}) {
    const std::string text = std::string("newmtl a\nKs 1 1 1\n") + written;
    CAPTURE(text);
    const Model model = load_with_library(triangle_and("mtllib a.mtl\nusemtl a\nf 1 2 3\n"), text);
    CHECK((model.materials[0].specular != glm::vec3{0.0f}) == shines);
  }
}

TEST_CASE("options of maps place the texture, or are told once") {
  const auto uvs_of = [](const std::string& map, std::size_t warnings) {
    CAPTURE(map);
    Model model =
        load_with_library(triangle_and("vt 0.25 0.5\nmtllib a.mtl\nusemtl a\nf 1/1 2/1 3/1\n"),
                          "newmtl a\nKd 1 1 1\n" + map + "\n");
    CHECK(model.materials[0].texture.has_value());
    CHECK(model.warnings.size() == warnings);
    place_uvs(model.parts[0].mesh, model.parts[0].placement);
    const glm::vec2 uv = model.parts[0].mesh.uvs[0];
    return glm::vec2{uv.x, 1.0f - uv.y};
  };
  CHECK(uvs_of("map_Kd wood.png", 0) == glm::vec2{0.25f, 0.5f});
  CHECK(uvs_of("map_Kd -s 4 4 wood.png", 0) == glm::vec2{1.0f, 2.0f});
  CHECK(uvs_of("map_kd -S 4 wood.png", 0) == glm::vec2{1.0f, 0.5f});
  CHECK(uvs_of("map_Kd -s 2 2 1 -o 0.5 0.25 0 wood.png", 0) == glm::vec2{1.0f, 1.25f});
  CHECK(uvs_of("map_Kd -o 0.5 -clamp on wood.png", 0) == glm::vec2{0.75f, 0.5f});
  CHECK(uvs_of("map_Kd -mm 0 1 -blendu off -mm 0.5 2 wood.png", 2) == glm::vec2{0.25f, 0.5f});
  CHECK(uvs_of("MAP_KD \"wood.png\"", 0) == glm::vec2{0.25f, 0.5f});
  const glm::vec2 turbulent = uvs_of("map_Kd -t 0.1 0 wood.png", 0);
  CHECK(turbulent.y == 0.5f);
  CHECK(std::fabs(turbulent.x - 0.25f) <= 0.1f);
  CHECK(turbulent.x != 0.25f);
}

TEST_CASE("a material whose name has a zero in it is no failure") {
  const std::string name("a\0b", 3);
  const Model model = load_with_library(triangle_and("mtllib a.mtl\nusemtl a\nf 1 2 3\n"),
                                        "newmtl " + name + "\nKd 1 0 0\nmap_Kd wood.png\n");
  CHECK(model.materials[0].diffuse == glm::vec3{1.0f, 0.0f, 0.0f});
}

TEST_CASE("a library with a byte order mark is read") {
  const Model model = load_with_library(triangle_and("mtllib a.mtl\nusemtl a\nf 1 2 3\n"),
                                        "\xEF\xBB\xBFnewmtl a\nKd 1 0 0\n");
  CHECK(model.materials[0].diffuse == glm::vec3{1.0f, 0.0f, 0.0f});
}

TEST_CASE("a map_d becomes an opacity texture, made once") {
  const Model model = load_with_library(
      triangle_and("v 0 0 1\nmtllib a.mtl\nusemtl a\nf 1 2 3\nusemtl b\nf 1 2 4\n"),
      "newmtl a\nKd 1 1 1\nmap_Kd wood.png\nmap_d -clamp on wood.png\nnewmtl b\nmap_d wood.png\n");
  REQUIRE(model.textures.size() == 2);
  CHECK(model.materials[0].texture == 0u);
  CHECK(model.materials[0].opacity_texture == 1u);
  CHECK(model.materials[1].opacity_texture == 1u);
  CHECK(model.materials[0].opacity_sampler.wrap_v == Wrap::clamp_to_edge);
  CHECK(model.materials[0].sampler.wrap_v == Wrap::repeat);
  CHECK(model.textures[1].levels[0].format == Format::rgba8);
  CHECK(model.textures[1].levels.size() == 3);
}

TEST_CASE("a map_d of 0 and 1 alone makes a cut-out") {
  const TemporaryDirectory directory;
  write_file(directory.file("a.obj"), triangle_and("v 0 0 1\nmtllib a.mtl\nusemtl a\nf 1 2 3\n"
                                                   "usemtl b\nf 1 2 4\n"));
  write_file(directory.file("a.mtl"), "newmtl a\nmap_d mask.png\nnewmtl b\nmap_d wood.png\n");
  write_file(directory.file("mask.png"), mask_bytes());
  write_file(directory.file("wood.png"), png_bytes(4, 4));
  const Model model = load_obj_model(directory.file("a.obj"));
  CHECK(model.materials[0].cut_out);
  CHECK_FALSE(model.materials[1].cut_out);
}

TEST_CASE("a map_d that is missing is a warning, and the surface stays as it is") {
  const Model model = load_with_library(triangle_and("mtllib a.mtl\nusemtl a\nf 1 2 3\n"),
                                        "newmtl a\nKd 1 0 0\nd 0.5\nmap_d leaf.png\n");
  REQUIRE(model.warnings.size() == 1);
  CHECK(contains(model.warnings[0], "a.mtl: material a: texture leaf.png is missing"));
  CHECK(model.materials[0].diffuse == glm::vec3{1.0f, 0.0f, 0.0f});
  CHECK(model.materials[0].opacity == 0.5f);
}

TEST_CASE("a missing library, material or texture is a warning, and grey stands in") {
  const Model without_library =
      load_with_library(triangle_and("mtllib a.mtl\nusemtl a\nf 1 2 3\n"));
  REQUIRE(without_library.warnings.size() == 2);
  CHECK(contains(without_library.warnings[0], "material library a.mtl is missing"));
  CHECK(contains(without_library.warnings[1], "material a is not defined"));
  CHECK(without_library.materials[without_library.parts[0].material].diffuse == glm::vec3{0.5f});

  const Model without_texture = load_with_library(triangle_and("mtllib a.mtl\nusemtl a\nf 1 2 3\n"),
                                                  "newmtl a\nKd 1 0 0\nmap_Kd stone.png\n");
  REQUIRE(without_texture.warnings.size() == 1);
  CHECK(contains(without_texture.warnings[0], "a.mtl: material a: texture stone.png is missing"));
  CHECK_FALSE(without_texture.materials[0].texture);
  CHECK(without_texture.materials[0].diffuse == glm::vec3{0.5f});
}

TEST_CASE("a texture in another format is left out with a warning") {
  const TemporaryDirectory directory;
  write_file(directory.file("a.obj"), triangle_and("mtllib a.mtl\nusemtl a\nf 1 2 3\n"));
  write_file(directory.file("a.mtl"), "newmtl a\nKd 1 0 0\nmap_Kd old.tga\n");
  write_file(directory.file("old.tga"), "anything");
  const Model model = load_obj_model(directory.file("a.obj"));
  REQUIRE(model.warnings.size() == 1);
  CHECK(contains(model.warnings[0], "neither PNG nor JPEG"));
}

TEST_CASE("a texture that is there and damaged is an error") {
  const TemporaryDirectory directory;
  write_file(directory.file("a.obj"), triangle_and("mtllib a.mtl\nusemtl a\nf 1 2 3\n"));
  write_file(directory.file("a.mtl"), "newmtl a\nKd 1 0 0\nmap_Kd wood.png\n");
  write_file(directory.file("wood.png"), png_bytes(32, 32).substr(0, 60));
  CHECK(contains(scene_error_of([&] { load_obj_model(directory.file("a.obj")); }), "wood.png: "));
}

TEST_CASE("a library's name may have blanks, and there may be several libraries") {
  const TemporaryDirectory directory;
  write_file(directory.file("my colours.mtl"), "newmtl a\nKd 1 0 0\n");
  write_file(directory.file("b.mtl"), "newmtl b\nKd 0 1 0\n");
  write_file(directory.file("a.obj"),
             triangle_and("v 0 0 1\nmtllib my colours.mtl\nmtllib b.mtl none.mtl\n"
                          "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 4\n"));
  const Model model = load_obj_model(directory.file("a.obj"));
  CHECK(model.materials[0].diffuse == glm::vec3{1.0f, 0.0f, 0.0f});
  CHECK(model.materials[1].diffuse == glm::vec3{0.0f, 1.0f, 0.0f});
  REQUIRE(model.warnings.size() == 1);
  CHECK(contains(model.warnings[0], "none.mtl"));
}

// glTF models: geometry, camera and lights against numbers by hand, and what is refused.

#include "scenes/models/gltf_model.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "raster/numbers/vector_math.h"
#include "scenes/load/load_scene.h"
#include "tests/scenes/models/gltf_text.h"

using namespace softfocus;
using namespace softfocus::test;

TEST_CASE("a triangle has its corners, flat normals, and the material for none") {
  if (lacks_gltf()) return;
  const Gltf gltf = triangle();
  for (const Model& model : {load(gltf), load(gltf.binary(), "model.glb")}) {
    CHECK(corners(model) == Corners{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}});
    CHECK(model.parts[0].mesh.normals == std::vector<glm::vec3>(3, {0, 0, 1}));
    CHECK(model.materials.at(model.parts[0].material).diffuse == glm::vec3{0.5f});
    CHECK(!model.camera);
    CHECK(model.lights.empty());
    CHECK(model.warnings.empty());
  }
}

TEST_CASE("nodes put meshes where all above them say, and copies are there each") {
  if (lacks_gltf()) return;
  Gltf gltf = triangle();
  // A quarter turn about y after a scale: (x, y, z) -> (z, y, -x).
  gltf.node(
      "\"children\":[1,2],\"translation\":[10,0,0],\"scale\":[2,3,4],"
      "\"rotation\":[0,0.70710678118654752,0,0.70710678118654752]");
  gltf.node("\"mesh\":0,\"translation\":[1,0,0]");
  gltf.node("\"mesh\":0,\"matrix\":[-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,5,1]");
  gltf.more = ",\"scenes\":[{\"nodes\":[0]}],\"scene\":0";
  const Model model = load(gltf);
  const Corners found = corners(model);
  const Corners right{{10, 0, -2}, {10, 0, -4}, {10, 6, -2}, {30, 0, 0}, {30, 6, 0}, {30, 0, 2}};
  REQUIRE(found.size() == right.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    // The mirrored copy is turned, so its front stays in front.
    const glm::vec3 off = found[i] - right[i];
    CAPTURE(i);
    CHECK(dot(off, off) < 1e-9f);
  }
  CHECK(model.parts.size() == 1);
  const Mesh& mesh = model.parts[0].mesh;
  for (std::size_t i = 0; i < 6; i += 3) {
    const glm::vec3 a = found[i];
    const glm::vec3 front = normalize(cross(found[i + 1] - a, found[i + 2] - a));
    CHECK(dot(front, mesh.normals[mesh.indices[i]]) > 0.999f);
  }
  // Without scenes, what is nobody's child.
  gltf.more = "";
  CHECK(corners(load(gltf)) == found);
}

TEST_CASE("normals go with the inverse transpose") {
  if (lacks_gltf()) return;
  Gltf gltf = triangle(",\"NORMAL\":1");
  gltf.floats({0, 0, 1, 0.6f, 0.8f, 0, 1, 0, 0}, "VEC3", 3);
  gltf.node("\"mesh\":0,\"scale\":[2,1,-1]");
  const Model model = load(gltf);
  const std::vector<glm::vec3>& normals = model.parts[0].mesh.normals;
  CHECK(normals[0] == glm::vec3{0, 0, -1});
  const glm::vec3 slanted = normalize(glm::vec3{0.3f, 0.8f, 0.0f});
  CHECK(std::fabs(normals[1].x - slanted.x) < 1e-6f);
  CHECK(std::fabs(normals[1].y - slanted.y) < 1e-6f);
  CHECK(corners(model) == Corners{{0, 0, 0}, {0, 2, 0}, {2, 0, 0}});
}

TEST_CASE("strips and fans, with and without indices; lines are left out") {
  if (lacks_gltf()) return;
  const auto of_mode = [](int mode, const std::string& also) {
    Gltf gltf;
    gltf.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0}, "VEC3", 3);
    gltf.add<std::uint8_t>({4, 3, 2, 1}, "SCALAR", 1, kByte);
    gltf.mesh("\"POSITION\":0", ",\"mode\":" + std::to_string(mode) + also);
    return gltf;
  };
  const glm::vec3 p[5] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 2, 0}};
  CHECK(corners(load(of_mode(5, ""))) ==
        Corners{p[0], p[1], p[2], p[1], p[3], p[2], p[2], p[3], p[4]});
  CHECK(corners(load(of_mode(5, ",\"indices\":1"))) == Corners{p[4], p[3], p[2], p[3], p[1], p[2]});
  CHECK(corners(load(of_mode(6, ""))) ==
        Corners{p[1], p[2], p[0], p[2], p[3], p[0], p[3], p[4], p[0]});
  CHECK(corners(load(of_mode(4, ",\"indices\":1"))) == Corners{p[4], p[3], p[2]});
  Gltf both = of_mode(1, "");
  CHECK(complaint(both.text()) == "has no triangles in its scene; a mesh would be right");
  both.mesh("\"POSITION\":0");
  both.node("\"mesh\":0");
  both.node("\"mesh\":1");
  const Model model = load(both);
  CHECK(corners(model).size() == 3);
  CHECK(warns(model, "points and lines are left out"));
}

TEST_CASE("whole numbers are shares of 1, elements may lie apart, and sparse ones replace others") {
  if (lacks_gltf()) return;
  Gltf gltf = triangle(",\"TEXCOORD_0\":1,\"COLOR_0\":2", ",\"indices\":3");
  gltf.add<std::uint16_t>({0, 65535, 32768, 0, 13107, 65535}, "VEC2", 2, kShort,
                          ",\"normalized\":true");
  gltf.add<std::uint8_t>({255, 0, 51, 255, 0, 255, 102, 0, 0, 0, 255, 9}, "VEC4", 4, kByte,
                         ",\"normalized\":true");
  gltf.add<std::uint32_t>({2, 0, 1}, "SCALAR", 1, kInt);
  const Model model = load(gltf);
  const Mesh& mesh = model.parts[0].mesh;
  const std::uint32_t first = mesh.indices[0];
  CHECK(mesh.positions[first] == glm::vec3{0, 2, 0});
  CHECK(mesh.uvs[first] == glm::vec2{0.2f, 1.0f});
  CHECK(mesh.colours[first] == glm::vec3{0, 0, 1});
  CHECK(mesh.colours[mesh.indices[1]] == glm::vec3{1, 0, 0.2f});

  Gltf quantised = triangle(",\"NORMAL\":1");
  quantised.add<std::int8_t>({0, 0, 127, 0, -127, 0, -128, 0, 0}, "VEC3", 3, 5120,
                             ",\"normalized\":true");
  const std::vector<glm::vec3> normals{{0, 0, 1}, {0, -1, 0}, {-1, 0, 0}};
  CHECK(load(quantised).parts[0].mesh.normals == normals);

  Gltf apart;
  // Positions and one number more, 16 bytes apart.
  std::string rows;
  for (const float number : {0.0f, 0.0f, 0.0f, 7.0f, 1.0f, 0.0f, 0.0f, 7.0f, 0.0f, 2.0f, 0.0f}) {
    std::uint32_t word = 0;
    std::memcpy(&word, &number, 4);
    for (int i = 0; i < 4; ++i) rows.push_back(static_cast<char>(word >> (8 * i) & 255));
  }
  apart.view(rows, 16);
  Gltf::item(apart.accessors,
             "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}");
  ++apart.accessor_count;
  apart.mesh("\"POSITION\":0");
  CHECK(corners(load(apart)) == Corners{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}});

  Gltf sparse;
  sparse.add<std::uint8_t>({1, 2}, "SCALAR", 1, kByte);
  sparse.floats({1, 0, 0, 0, 2, 0}, "VEC3", 3);
  Gltf::item(
      sparse.accessors,
      "{\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"sparse\":{\"count\":2,"
      "\"indices\":{\"bufferView\":0,\"componentType\":5121},\"values\":{\"bufferView\":1}}}");
  sparse.mesh("\"POSITION\":2");
  CHECK(corners(load(sparse)) == Corners{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}});
}

TEST_CASE("a skin's joints move what they hold, and morph targets add to it") {
  if (lacks_gltf()) return;
  Gltf gltf = triangle(",\"JOINTS_0\":1,\"WEIGHTS_0\":2", ",\"targets\":[{\"POSITION\":4}]");
  gltf.add<std::uint8_t>({0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}, "VEC4", 4, kByte);
  gltf.floats({1, 0, 0, 0, 1, 0, 0, 0, 0.5f, 0.5f, 0, 0}, "VEC4", 4);
  const std::vector<float> here{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  std::vector<float> both = here;
  both.insert(both.end(), {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -3, 0, 0, 1});
  gltf.floats(both, "MAT4", 16);
  gltf.floats({0, 0, 4, 0, 0, 0, 0, 0, 0}, "VEC3", 3);
  // The node's own place counts for nothing; joint 1 was bound 3 to the right and is 5 up there.
  gltf.node("\"mesh\":0,\"skin\":0,\"translation\":[100,100,100],\"weights\":[0.5]");
  gltf.node("\"translation\":[0,0,1]");
  gltf.node("\"translation\":[3,5,0]");
  gltf.more = ",\"skins\":[{\"joints\":[1,2],\"inverseBindMatrices\":3}]";
  CHECK(corners(load(gltf)) == Corners{{0, 0, 3}, {1, 5, 0}, {0, 4.5f, 0.5f}});
}

TEST_CASE("skins mirror, have more than four joints, and name none that is not there") {
  if (lacks_gltf()) return;
  Gltf gltf = triangle(",\"JOINTS_0\":1,\"WEIGHTS_0\":2,\"JOINTS_1\":1,\"WEIGHTS_1\":3");
  gltf.add<std::uint8_t>({0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}, "VEC4", 4, kByte);
  gltf.floats({0.5f, 0, 0, 0, 0.5f, 0, 0, 0, 0.5f, 0, 0, 0}, "VEC4", 4);
  gltf.floats({0.5f, 0, 0, 0, 0.5f, 0, 0, 0, 0, 0.5f, 0, 0}, "VEC4", 4);
  gltf.node("\"children\":[1,2,3],\"scale\":[-1,1,1]");
  gltf.node("\"mesh\":0,\"skin\":0");
  gltf.node("\"translation\":[0,0,1]");
  gltf.node("\"translation\":[3,5,0]");
  gltf.more =
      ",\"skins\":[{\"joints\":[2,3]}],\"scenes\":[{\"nodes\":[3]},{\"nodes\":[0]}],\"scene\":1";
  // The last corner is half of each joint's; the triangle is turned.
  CHECK(corners(load(gltf)) == Corners{{0, 0, 1}, {-1.5f, 4.5f, 0.5f}, {-4, 5, 0}});
  gltf.more = ",\"skins\":[{\"joints\":[2]}]";
  CHECK(complaint(gltf.text()) == "a vertex names a joint past the 1 of its skin");
  gltf.more = ",\"skins\":[{\"joints\":[2,9]}]";
  CHECK(complaint(gltf.text()) == "there is no node 9 of 4");
}

TEST_CASE("a morph target's normals count; without any the triangles' own do") {
  if (lacks_gltf()) return;
  const auto of = [](const std::string& target) {
    Gltf gltf = triangle(",\"NORMAL\":1", ",\"targets\":[{\"POSITION\":2" + target + "}]");
    gltf.floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3);
    gltf.floats({0, 0, 0, 0, 0, 1, 0, 0, 0}, "VEC3", 3);
    gltf.floats({1, 0, -1, 1, 0, -1, 1, 0, -1}, "VEC3", 3);
    gltf.node("\"mesh\":0,\"weights\":[1]");
    const Model model = load(gltf);
    return model.parts[0].mesh.normals[0];
  };
  CHECK(of(",\"NORMAL\":3") == glm::vec3{1, 0, 0});
  const glm::vec3 flat = of("");
  CHECK(std::fabs(flat.x + std::sqrt(0.5f)) < 1e-6f);
}

TEST_CASE("vertices that a primitive leaves out are nowhere, whoever shares them") {
  if (lacks_gltf()) return;
  Gltf gltf;
  gltf.floats({0, 0, 0, 1, 0, 0, 0, 2, 0, 3e9f, 0, 0, 0, 0, 1}, "VEC3", 3);
  gltf.floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3);
  gltf.add<std::uint8_t>({0, 1, 2}, "SCALAR", 1, kByte);
  gltf.add<std::uint8_t>({0, 1, 4}, "SCALAR", 1, kByte);
  const std::string both = "{\"attributes\":{\"POSITION\":0,\"NORMAL\":1},\"indices\":";
  Gltf::item(gltf.meshes, "{\"primitives\":[" + both + "2}," + both + "3}]}");
  const Model model = load(gltf);
  CHECK(model.parts[0].mesh.positions.size() == 6);
  CHECK(corners(model)[5] == glm::vec3{0, 0, 1});
}

TEST_CASE("the first camera and the lights stand where their nodes are") {
  if (lacks_gltf()) return;
  Gltf gltf = triangle();
  gltf.node("\"mesh\":0");
  gltf.node("\"camera\":0,\"translation\":[0,1,4]");
  gltf.node("\"translation\":[2,1,0],\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}");
  gltf.node(
      "\"rotation\":[-0.70710678118654752,0,0,0.70710678118654752],"
      "\"extensions\":{\"KHR_lights_punctual\":{\"light\":1}}");
  gltf.more =
      ",\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":0.78539816339744831,"
      "\"znear\":0.1}}],\"extensions\":{\"KHR_lights_punctual\":{\"lights\":["
      "{\"type\":\"point\",\"intensity\":9,\"color\":[1,0.5,0]},"
      "{\"type\":\"directional\",\"intensity\":2}]}}";
  const Model model = load(gltf);
  REQUIRE(model.camera);
  CHECK(model.camera->position == glm::dvec3{0, 1, 4});
  CHECK(model.camera->target == glm::dvec3{0, 1, 3});
  CHECK(model.camera->fov_y_degrees == doctest::Approx(45.0));
  REQUIRE(model.lights.size() == 2);
  CHECK(model.lights[0].kind == LightKind::point);
  CHECK(model.lights[0].position_or_direction == glm::vec3{2, 1, 0});
  // 9 at (2, 1, 0), seen from the middle (0.5, 1, 0): 4 of 4.
  CHECK(model.lights[0].colour == glm::vec3{1.0f, 0.5f, 0.0f});
  CHECK(model.lights[1].kind == LightKind::directional);
  CHECK(model.lights[1].position_or_direction.y == doctest::Approx(1.0));
  CHECK(model.lights[1].colour == glm::vec3{0.5f});

  const TemporaryDirectory directory;
  write_file(directory.file("model.GLB"), gltf.binary());
  const Scene scene = load_scene(directory.file("model.GLB"), {});
  CHECK(scene.camera.position == glm::dvec3{0, 1, 4});
  CHECK(scene.camera.far_m == doctest::Approx(6.0));
  CHECK(scene.camera.near_m == doctest::Approx(2.0));
  CHECK(scene.lights.size() == 2);
  CHECK(scene.lens.lens.focus_m == doctest::Approx(4.0));
}

TEST_CASE(
    "a camera that looks at nothing is in focus in the middle, one that cannot look is none") {
  if (lacks_gltf()) return;
  Gltf gltf = triangle();
  gltf.node("\"mesh\":0,\"translation\":[0,0,-3]");
  gltf.node("\"camera\":0,\"translation\":[-1,-1,0]");
  const std::string camera =
      ",\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":1,\"znear\":0.1}}]";
  gltf.more = camera;
  const TemporaryDirectory directory;
  write_file(directory.file("m.gltf"), gltf.text());
  const Scene scene = load_scene(directory.file("m.gltf"), {});
  CHECK(scene.lens.lens.focus_m == doctest::Approx(3.0));
  Gltf flat = triangle();
  flat.node("\"mesh\":0");
  flat.node(
      "\"camera\":0,\"scale\":[0,0,0],\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}");
  flat.more = camera +
              ",\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"directional\"}]}}";
  const Model model = load(flat);
  CHECK(!model.camera);
  CHECK(model.lights.empty());
  CHECK(warns(model, "a camera without a place or a direction is left out"));
  CHECK(warns(model, "a light without a direction is left out"));
  Gltf wide = triangle();
  wide.node("\"mesh\":0");
  wide.node("\"camera\":0,\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}");
  wide.more =
      ",\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":3,\"znear\":0.1}}],"
      "\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"spot\",\"spot\":{},"
      "\"spot\":{},\"intensity\":0}]}}";
  const Model dark = load(wide);
  CHECK(!dark.camera);
  CHECK(warns(dark, "a camera of 171.887339 degrees is left out"));
  CHECK(warns(dark, "a spot light shines in all directions"));
  CHECK(warns(dark, "lights that give nothing"));
  CHECK(dark.lights.empty());
}

TEST_CASE("a model far from the origin for its size comes back to it") {
  if (lacks_gltf()) return;
  Gltf gltf = triangle();
  gltf.node("\"mesh\":0,\"translation\":[500000,20,4000000]");
  const Model model = load(gltf);
  CHECK(model.origin == glm::dvec3{500001, 21, 4000000});
  CHECK(corners(model) == Corners{{-1, -1, 0}, {0, -1, 0}, {-1, 1, 0}});
  CHECK(warns(model, "is far from the origin for its size"));
}

TEST_CASE("a scene puts a glTF model where an object says") {
  if (lacks_gltf()) return;
  const TemporaryDirectory directory;
  write_file(directory.file("model.glb"), triangle().binary());
  const Scene scene = read_scene_text(
      "[camera]\nposition = [0, 0, 3]\n[lens]\nfocus_m = 3\n[[object]]\n"
      "shape = \"model\"\nfile = \"model.glb\"\nposition = [1, 2, 3]\n",
      directory.file("scene.toml"));
  REQUIRE(scene.objects.size() == 1);
  CHECK(scene.objects[0].position == glm::dvec3{1, 2, 3});
  CHECK(scene.meshes[0].positions.size() == 3);
}

TEST_CASE("what is no glTF 2.0, or goes past its bytes, is refused") {
  if (lacks_gltf()) return;
  const std::string good = triangle().text();
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    return complaint(text.replace(at, from.size(), to));
  };
  CHECK(complaint("").starts_with("cannot be read"));
  CHECK(complaint("{}").starts_with("cannot be read"));
  CHECK(complaint("glTF").starts_with("cannot be read"));
  CHECK(with("\"2.0\"", "\"1.0\"") == "is glTF 1.0; a glTF 2.0 file would do");
  const std::string binary = triangle().binary();
  for (std::size_t size = 0; size < binary.size(); size += 7) {
    CHECK(complaint(binary.substr(0, size)).starts_with("cannot be read"));
  }
  CHECK(with("\"count\":3", "\"count\":4") ==
        "bufferView 0 is shorter than what is read from it, or its buffer ends before");
  CHECK(with("\"count\":3", "\"count\":4000000000000").find("accessor 0") == 0);
  CHECK(with("\"POSITION\":0", "\"POSITION\":9") == "there is no accessor 9 of 1");
  CHECK(with("{\"mesh\":0}", "{\"mesh\":3}") == "there is no mesh 3 of 1");
  CHECK(with("{\"mesh\":0}", "{\"mesh\":0,\"children\":[0]}") ==
        "has no triangles in its scene; a mesh would be right");
  CHECK(with("{\"mesh\":0}]", "{\"mesh\":0,\"children\":[0]}],\"scenes\":[{\"nodes\":[0]}]") ==
        "node 0 is in two places, or below itself; a tree would be right");
  CHECK(with("\"2.0\"}", "\"2.0\"},\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]") ==
        "its geometry is packed (KHR_draco_mesh_compression); the same model without compression "
        "would do");
  CHECK(with("\"2.0\"}", "\"2.0\"},\"extensionsRequired\":[\"EXT_mesh_gpu_instancing\"]") ==
        "needs EXT_mesh_gpu_instancing, which is not understood; the same model without it would "
        "do");
  CHECK(with("\"2.0\"", "\"2.0\",\"extras\":" + std::string(100000, '[')) ==
        "has lists in each other, deeper than 256");
  CHECK(with("\"bufferView\":0,\"componentType\":5126,\"count\":3",
             "\"componentType\":5126,\"count\":3000000") ==
        "accessor 0 has 3000000 elements and no buffer; up to 1398101 would do");
  std::string chain = "{\"mesh\":0,\"children\":[1]}";
  for (int i = 2; i < 1100; ++i) chain += ",{\"children\":[" + std::to_string(i) + "]}";
  CHECK(with("{\"mesh\":0}", chain + ",{}") == "node 1001 lies below more than 1000 others");
  CHECK(with("base64,", "base65,").size() < 400);
  Gltf floating = triangle("", ",\"indices\":1");
  floating.floats({0, 1, 2}, "SCALAR", 1);
  CHECK(complaint(floating.text()) == "indices are not unsigned whole numbers");
  Gltf indexed = triangle("", ",\"indices\":1");
  indexed.add<std::uint8_t>({0, 1, 3}, "SCALAR", 1, kByte);
  CHECK(complaint(indexed.text()) == "an index is 3 of 3 vertices");
  Gltf infinite;
  infinite.floats({0, 0, 0, 1, 0, 0, 0, std::numeric_limits<float>::infinity(), 0}, "VEC3", 3);
  infinite.mesh("\"POSITION\":0");
  CHECK(complaint(infinite.text()) == "a position is no number, or beyond 1e9");
  Gltf coloured = triangle(",\"COLOR_0\":1");
  coloured.floats({1, 1, 1, 1, 1, 1}, "VEC3", 3);
  CHECK(complaint(coloured.text()) ==
        "COLOR_0 has 2 elements of 3 numbers where 3 of 3 would be right");
}

#include "scenes/models/obj_model.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "scenes/draw/frame_matrices.h"
#include "scenes/load/model_scene.h"
#include "scenes/models/obj_text.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/scene_test_files.h"

using namespace softfocus;
using namespace softfocus::test;

namespace {

constexpr std::string_view kCube =
    "v -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
    "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\n"
    "f 1 2 3 4\nf 6 5 8 7\nf 2 6 7 3\nf 5 1 4 8\nf 4 3 7 8\nf 5 6 2 1\n";

ObjText parse(std::string_view text) { return parse_obj_text(text, "a.obj"); }

std::string complaint(std::string_view text) {
  return scene_error_of([&] { parse(text); });
}

// The model of a text, and of a library if one is given.
Model load(std::string_view obj, std::string_view mtl = "") {
  const TemporaryDirectory directory;
  write_file(directory.file("a.obj"), obj);
  if (!mtl.empty()) write_file(directory.file("a.mtl"), mtl);
  write_file(directory.file("wood.png"), png_bytes(4, 4));
  return load_obj_model(directory.file("a.obj"));
}

constexpr std::string_view kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

std::string triangle_with(std::string_view lines) {
  return std::string(kTriangle) + std::string(lines);
}

}  // namespace

// --- the text -------------------------------------------------------------------------

TEST_CASE("numbers are the floats nearest to their decimals") {
  const ObjText obj = parse("v 0.1 -1e-3 +2.5\nv 16777217 1e-50 3.4028e-39\nv 0 1 0\nf 1 2 3\n");
  CHECK(obj.positions[0] == glm::vec3{0.1f, -1e-3f, 2.5f});
  CHECK(obj.positions[1] == glm::vec3{16777216.0f, 0.0f, 3.4028e-39f});
}

namespace {

// A long text that is read in pieces: 60000 triangles of their own corners, counted back or from
// the first, of one material and smoothing group in a thousand; the later half is coloured.
constexpr std::size_t kLongFaces = 60000;

std::string long_text(bool counts_back = true) {
  std::string text = "mtllib a.mtl\n";
  for (std::size_t i = 0; i < kLongFaces; ++i) {
    const std::string number = std::to_string(i);
    text += "v " + number + " 0 0\nv " + number + " 1 0 # the second\nv " + number + " 0 1";
    text += i < kLongFaces / 2 ? "\n" : " 0.25 0.5 0\n";
    text += "vt " + number + " 0\nvn 0 0 " + number + "1\n";
    if (i % 1000 == 500) text += "usemtl m" + number + "\ns " + number + "\n";
    const auto index = [&](std::size_t count, std::size_t back) {
      return counts_back ? "-" + std::to_string(back) : std::to_string(count * (i + 1) + 1 - back);
    };
    text += "f " + index(3, 3) + "/" + index(1, 1) + "/" + index(1, 1) + " " + index(3, 2);
    text += (i % 7 == 0 ? " \\\n " : " ") + index(3, 1) + "\n";
  }
  return text;
}

}  // namespace

TEST_CASE("a long text has the same numbers, materials and groups in pieces") {
  bool counts_back = false;
  SUBCASE("indices from the first") {}
  SUBCASE("indices that count back") { counts_back = true; }
  const std::string text = long_text(counts_back);
  REQUIRE(text.size() > std::size_t{3} << 20);
  ThreadPool pool{3};
  const ObjText obj = parse_obj_text(text, "a.obj", {}, &pool);
  REQUIRE(obj.faces.size() == kLongFaces);
  REQUIRE(obj.positions.size() == 3 * kLongFaces);
  REQUIRE(obj.colours.size() == obj.positions.size());
  REQUIRE(obj.uvs.size() == kLongFaces);
  REQUIRE(obj.normals.size() == kLongFaces);
  REQUIRE(obj.material_names.size() == kLongFaces / 1000);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < kLongFaces; ++i) {
    const ObjFace& face = obj.faces[i];
    const auto set = static_cast<std::int32_t>((i + 500) / 1000) - 1;
    const std::uint32_t group = set < 0 ? 0 : static_cast<std::uint32_t>(set * 1000 + 500);
    wrong += face.first_corner != 3 * i || face.corner_count != 3 || face.material != set ||
             face.smoothing_group != group;
    for (std::size_t k = 0; k < 3; ++k) {
      wrong += obj.corners[3 * i + k].position != static_cast<std::int32_t>(3 * i + k);
    }
    wrong += obj.corners[3 * i].uv != static_cast<std::int32_t>(i) ||
             obj.corners[3 * i].normal != static_cast<std::int32_t>(i);
    wrong +=
        obj.uvs[i].x != static_cast<float>(i) || obj.normals[i].z != static_cast<float>(10 * i + 1);
    const glm::vec3 colour = i < kLongFaces / 2 ? glm::vec3{1.0f} : glm::vec3{0.25f, 0.5f, 0.0f};
    wrong += obj.colours[3 * i] != glm::vec3{1.0f} || obj.colours[3 * i + 2] != colour;
    wrong += obj.positions[3 * i + 1] != glm::vec3{static_cast<float>(i), 1.0f, 0.0f};
  }
  CHECK(wrong == 0);
  CHECK(obj.libraries == std::vector<std::string>{"a.mtl"});
}

TEST_CASE("an index counts back from its place in the whole text, not in its piece") {
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nf -3/-1/-1 -2 -1\n";
  const std::string comment = "#" + std::string(std::size_t{1} << 20, 'x') + "\n";
  const ObjText obj = parse(triangle + comment + triangle);
  REQUIRE(obj.corners.size() == 6);
  for (std::int32_t i = 0; i < 6; ++i) {
    CHECK(obj.corners[static_cast<std::size_t>(i)].position == i);
  }
  CHECK(obj.corners[3].uv == 1);
  CHECK(obj.corners[3].normal == 1);
}

TEST_CASE("a line that goes on behind a backslash is in one piece") {
  constexpr std::size_t kPieceBytes = std::size_t{1} << 20;
  for (const std::string end : {"\n", "\r\n"}) {
    const std::string begin = "v 0 0 0\nv 1 0 0\nv 0 1 0\n#", face = "\nf 1 2 \\";
    for (std::size_t shift = 0; shift < face.size() + 4; ++shift) {
      const std::string comment(kPieceBytes - begin.size() - shift, 'x');
      ThreadPool pool{2};
      const ObjText obj =
          parse_obj_text(begin + comment + face + end + " 3" + end, "a.obj", {}, &pool);
      CAPTURE(shift);
      CHECK(obj.corners.size() == 3);
    }
  }
}

TEST_CASE("the first error of a long text is told, with its line" * doctest::test_suite("long")) {
  bool counts_back = false;
  SUBCASE("indices from the first") {}
  SUBCASE("indices that count back") { counts_back = true; }
  std::string text = long_text(counts_back);
  const auto line_of = [&](std::size_t place) {
    return std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(place), '\n') + 1;
  };
  for (const std::size_t after : {text.size() - 100, text.size() / 2, std::size_t{5000}}) {
    const std::size_t place = text.find("\nv ", after) + 1;
    text.replace(place, 3, "v x");
    CHECK(complaint(text).starts_with("a.obj:" + std::to_string(line_of(place)) + ": \"x"));
  }
  text = long_text(counts_back) + "f 1 2 999999999\n";
  CHECK(complaint(text).starts_with("a.obj:" + std::to_string(line_of(text.size() - 1)) + ": "));
}

TEST_CASE("what is left out of a long text is told with the line of the first") {
  for (const bool counts_back : {false, true}) {
    const std::string text = long_text(counts_back);
    const auto lines = std::to_string(std::count(text.begin(), text.end(), '\n') + 1);
    const ObjText obj = parse(text + "f 1 2\nf 1 2\nf 1/999999999 2 3\nvt x\n");
    REQUIRE(obj.warnings.size() == 3);
    CHECK(obj.warnings[0].starts_with("a.obj:" + lines + ": 2 faces"));
    CHECK(contains(obj.warnings[1], "texture coordinate is out of range"));
    CHECK(contains(obj.warnings[2], "texture coordinate is not there"));
  }
}

TEST_CASE("corners may have texture coordinates and normals, or leave them out") {
  const ObjText obj = parse(
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 0.5\nvn 0 0 1\n"
      "f 1/1/1 2/2/1 3//1\nf 1/1 2/2 3\n");
  CHECK(obj.uvs[1] == glm::vec2{0.5f, 0.0f});
  CHECK(obj.corners[1].uv == 1);
  CHECK(obj.corners[2].uv == -1);
  CHECK(obj.corners[2].normal == 0);
  CHECK(obj.corners[4].normal == -1);
}

TEST_CASE("negative indices count back from the last vertex so far") {
  const ObjText obj = parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5\nf -1 1 2\n");
  CHECK(obj.corners[0].position == 0);
  CHECK(obj.corners[2].position == 2);
  CHECK(obj.corners[3].position == 3);
}

TEST_CASE("a face may come before its vertices") {
  CHECK(parse("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n").faces.size() == 1);
}

TEST_CASE("lines may end as on Windows or an old Mac, and go on after a backslash") {
  const std::string text = triangle_with("f 1 \\\n2 3\n");
  std::string windows;
  std::string mac;
  for (const char c : text) {
    windows += c == '\n' ? std::string("\r\n") : std::string(1, c);
    mac += c == '\n' ? '\r' : c;
  }
  for (const std::string& each : {text, windows, mac}) {
    CHECK(parse(each).positions.size() == 3);
    CHECK(parse(each).faces[0].corner_count == 3);
  }
}

TEST_CASE("a byte order mark is no part of the first line") {
  CHECK(parse("\xEF\xBB\xBF" + triangle_with("f 1 2 3\n")).positions.size() == 3);
}

TEST_CASE("comments, groups and what else there may be are passed over") {
  CHECK(parse(triangle_with("# a comment\no thing\ng group\nl 1 2\np 1\nvp 0.1\nfoo bar\n"
                            "f 1 2 3 # done\n"))
            .faces.size() == 1);
}

TEST_CASE("a complaint about the text names the file, the line and what would be right") {
  CHECK(complaint(triangle_with("f 1 2 4\n")) ==
        "a.obj:4: the face refers to position 4; the file has 3");
  CHECK(complaint(triangle_with("f 1//9 2 3\n")) ==
        "a.obj:4: the face refers to normal 9; the file has 0");
  CHECK(complaint(triangle_with("f 1 2 0\n")) ==
        "a.obj:4: \"0\" is no index of a position; a whole number from 1, or from -1 "
        "backwards, would be right");
  CHECK(complaint(triangle_with("f 1 2 -4\n")) ==
        "a.obj:4: -4 goes back before the first position; there are 3 so far");
  CHECK(complaint(triangle_with("f 1 2 99999999999\n")) ==
        "a.obj:4: \"99999999999\" is no index of a position; a whole number from 1, or "
        "from -1 backwards, would be right");
  CHECK(contains(complaint(triangle_with("f 1 2 x\n")), "a.obj:4: \"x\" is no index"));
  for (const std::string word : {"/1", "//1", "/"}) {
    CHECK(contains(complaint(triangle_with("f 1 2 " + word + "\n")), "\"\" is no index of a pos"));
  }
  CHECK(contains(complaint(triangle_with("f 1 2 3.5\n")), "a.obj:4: \"3.5\" is no index"));
  CHECK(complaint("v 0 0 0\nv 1 nan 0\n") ==
        "a.obj:2: nan is out of range; a number from -1e9 to 1e9 would be right");
  CHECK(contains(complaint("v 0 0 inf\n"), "a.obj:1: inf is out of range"));
  CHECK(contains(complaint("v 0 0 1e39\n"), "a.obj:1: 1e39 is out of range"));
  CHECK(contains(complaint("v 0 0 2e9\n"), "a.obj:1: 2e9 is out of range"));
  CHECK(complaint("v 0 0\n") == "a.obj:1: has 2 numbers; 3 would be right");
  CHECK(complaint("v 0 zero 0\n") == "a.obj:1: \"zero\" is no number");
}

TEST_CASE("a face of one or two corners is left out with a warning") {
  const ObjText obj = parse(triangle_with("f 1\nf 1 2 3\nf 2 3\nf 3 1 2\n"));
  REQUIRE(obj.faces.size() == 2);
  CHECK(obj.corners.size() == 6);
  CHECK(obj.corners[obj.faces[1].first_corner].position == 2);
  REQUIRE(obj.warnings.size() == 1);
  CHECK(obj.warnings[0] ==
        "a.obj:4: 2 faces have fewer than 3 corners and are left out, the first in this line");
  CHECK(parse(triangle_with("f 1 2 3\nf 1\n")).warnings.at(0) ==
        "a.obj:5: a face has fewer than 3 corners and is left out");
  CHECK(complaint(triangle_with("f 1 2\n")) ==
        "a.obj:4: the face has fewer than 3 corners, as all have; a face of 3 or more would be "
        "right");
}

TEST_CASE("numbers that are none refuse no model where they are not needed") {
  const ObjText obj = parse(triangle_with(
      "vt -1.#IND 0\nvt\nvn nan nan nan\nvn 1.#QNAN 0 0\nvn 0 0 1\nf 1/1/1 2/2/2 3//3\n"));
  CHECK(obj.uvs[0] == glm::vec2{0.0f});
  CHECK(obj.normals[1] == glm::vec3{0.0f});
  CHECK(obj.normals[2] == glm::vec3{0.0f, 0.0f, 1.0f});
  REQUIRE(obj.warnings.size() == 2);
  CHECK(contains(obj.warnings[0], "a.obj:4: 2 texture coordinates are out of range"));
  CHECK(contains(obj.warnings[1], "a.obj:6: 2 normals are no directions"));
  const Model model = load(triangle_with("vn nan nan nan\nf 1//1 2//1 3//1\n"));
  CHECK(model.parts[0].mesh.normals[0] == glm::vec3{0.0f, 0.0f, 1.0f});
}

TEST_CASE("a backslash continues a line, blanks after it or not") {
  CHECK(parse(triangle_with("f 1 2 \\\n3\n")).corners.size() == 3);
  CHECK(parse(triangle_with("f 1 2 \\ \t\r\n 3\n")).corners.size() == 3);
}

TEST_CASE("a model may be UTF-16 of either byte order") {
  const auto utf16 = [](std::string_view text, bool high_byte_first) {
    std::string bytes = high_byte_first ? "\xFE\xFF" : "\xFF\xFE";
    for (const char letter : text) {
      bytes.append({high_byte_first ? '\0' : letter, high_byte_first ? letter : '\0'});
    }
    return bytes;
  };
  const std::string text = triangle_with("mtllib a.mtl\nusemtl m\nf 1 2 3\n");
  for (const bool high_byte_first : {false, true}) {
    const Model model =
        load(utf16(text, high_byte_first), utf16("newmtl m\nKd 1 0 0\n", high_byte_first));
    CHECK(model.materials[model.parts[0].material].diffuse == glm::vec3{1.0f, 0.0f, 0.0f});
  }
}

TEST_CASE("vertex colours come with the mesh, from 0 to 1 or to 255") {
  for (const auto& [scale, text] :
       {std::pair{1.0f, "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0\nf 1 2 3\n"},
        {255.0f, "v 0 0 0 255 0 0\nv 1 0 0 0 255 0\nv 0 1 0 255 255 255\nf 1 2 3\n"}}) {
    const Model model = load(text);
    const auto& colours = model.parts[0].mesh.colours;
    REQUIRE(colours.size() == 3);
    CHECK(colours[0] == glm::vec3{1.0f, 0.0f, 0.0f});
    CHECK(colours[1] == glm::vec3{0.0f, 1.0f, 0.0f});
    CHECK(colours[2] == glm::vec3{1.0f});
    CHECK(model.warnings.size() == (scale == 1.0f ? 0 : 1));
  }
  CHECK(load("v 0 0 0 1\nv 1 0 0 1\nv 0 1 0 1\nf 1 2 3\n").parts[0].mesh.colours.empty());
}

TEST_CASE("a model far from the origin has the bits of the same one there, and keeps its place") {
  const std::string near = "v -0.125 0 0\nv 0.375 0.25 0\nv 0 1.5 0.75\nf 1 2 3\n";
  const std::string far =
      "v 446521.875 5572094 -18\nv 446522.375 5572094.25 -18\nv 446522 5572095.5 -17.25\n"
      "f 1 2 3\n";
  const Model model = load(far);
  CHECK(model.origin == glm::dvec3{446522.0, 5572095.0, -18.0});
  REQUIRE(model.warnings.size() == 1);
  CHECK(contains(model.warnings[0], "(446522, 5572095, -18) is subtracted"));
  const auto moved = load(near).parts[0].mesh.positions;
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(model.parts[0].mesh.positions[i] == moved[i] - glm::vec3{0.0f, 1.0f, 0.0f});
  }
  Scene scene;
  add_model(scene, model, Object{}, std::nullopt);
  const glm::dmat4 to_world = object_matrix(scene.objects[0], 0.0);
  CHECK(to_world[3][1] == 5572095.0);
  CHECK(load(near).origin == glm::dvec3{0.0});
}

TEST_CASE("a texture coordinate out of range is 0, with a warning") {
  const ObjText obj =
      parse(triangle_with("vt 3443870976 0.5\nvt 0.5 nan\nvt 0.25 1e9\nf 1/1 2/2 3/3\n"));
  CHECK(obj.uvs[0] == glm::vec2{0.0f});
  CHECK(obj.uvs[1] == glm::vec2{0.0f});
  CHECK(obj.uvs[2] == glm::vec2{0.25f, 1e9f});
  REQUIRE(obj.warnings.size() == 1);
  CHECK(obj.warnings[0] ==
        "a.obj:4: 2 texture coordinates are out of range; 0 stands in, the first in this line");
}

TEST_CASE("a corner whose texture coordinate is not there has none, with a warning") {
  const ObjText obj = parse(triangle_with("vt 0.5 0.5\nf 1/1 2/2 3/9\n"));
  CHECK(obj.corners[0].uv == 0);
  CHECK(obj.corners[1].uv == -1);
  CHECK(obj.corners[2].uv == -1);
  REQUIRE(obj.warnings.size() == 1);
  CHECK(contains(obj.warnings[0], "a.obj:5: 2 corners' texture coordinates are not there"));
}

TEST_CASE("a complaint counts the lines that a backslash joins") {
  CHECK(contains(complaint(triangle_with("f 1 \\\n2 \\\n3\nf 1 2 9\n")), "a.obj:7:"));
}

TEST_CASE("a face of very many corners is refused") {
  std::string face = "f";
  for (int i = 0; i < 1025; ++i) face += " 1";
  CHECK(complaint(triangle_with(face)) ==
        "a.obj:4: the face has more than 1024 corners; smaller faces would do");
}

TEST_CASE("what is no model is said to be none") {
  CHECK(complaint("") == "a.obj: has no face; an OBJ model with `v` and `f` lines would be right");
  CHECK(contains(complaint("<html>not found</html>"), "has no face"));
  CHECK(contains(complaint(kTriangle), "has no face"));
  CHECK(complaint(std::string("v 0 0 0\n\0\1\2", 11)) == "a.obj: is binary; an OBJ model is text");
}

TEST_CASE("a missing model and a directory are named") {
  CHECK(scene_error_of([] { load_obj_model("/nowhere/a.obj"); }) ==
        "/nowhere/a.obj: no such file; check the path");
  CHECK(scene_error_of([] { load_obj_model("/tmp"); }) ==
        "/tmp: is a directory; give a file in it");
}

TEST_CASE("damaged text gives a complaint or a model, and nothing else") {
  const std::string whole =
      std::string(kCube) + "vt 0.5 0.5\nvn 0 0 1\ns 1\nusemtl a\nf 1/1/1 2/1/1 3/1/1\n";
  for (std::size_t i = 0; i < whole.size(); ++i) {
    for (const char damage : {'-', '9', ' ', '/', '\n', 'e'}) {
      std::string text = whole;
      text[i] = damage;
      const TemporaryDirectory directory;
      write_file(directory.file("a.obj"), text);
      const std::string message = scene_error_of([&] {
        const Model model = load_obj_model(directory.file("a.obj"));
        for (const auto& part : model.parts) {
          for (const std::uint32_t index : part.mesh.indices) {
            CHECK_UNARY(index < part.mesh.positions.size());
          }
        }
      });
      CHECK_UNARY(message.find('\n') == std::string::npos);
    }
  }
}

// --- the mesh -------------------------------------------------------------------------

TEST_CASE("a cube of quadrilaterals is a closed mesh of twelve triangles") {
  const Model model = load(kCube);
  REQUIRE(model.parts.size() == 1);
  const Mesh& mesh = model.parts[0].mesh;
  CHECK(mesh.indices.size() == 36);
  CHECK(is_closed(weld(mesh)));
  CHECK(volume(mesh) == doctest::Approx(8.0));
}

TEST_CASE("corners that are equal share a vertex") {
  CHECK(load(kCube).parts[0].mesh.positions.size() == 8);
}

TEST_CASE("without normals and smoothing groups, a model is smooth") {
  const Mesh mesh = load(kCube).parts[0].mesh;
  CHECK(normal_length_error(mesh) < 2e-7);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    // A corner of the cube leans to all three sides, if not to each alike: two of its
    // faces may give it two triangles.
    for (int axis = 0; axis < 3; ++axis)
      CHECK(mesh.normals[i][axis] * mesh.positions[i][axis] > 0.3f);
  }
}

TEST_CASE("made normals are weighted by area") {
  // A large triangle in z = 0 and one a hundredth its size upright, joined at an edge.
  const Mesh mesh =
      load("v 0 0 0\nv 1 0 0\nv 0 10 0\nv 0 0 -0.1\nf 1 2 3\nf 2 1 4\n").parts[0].mesh;
  CHECK(mesh.normals[0].z > 0.99f);
}

TEST_CASE("places that are equal are smooth across two vertices") {
  // The fold's two faces name the common edge by vertices of their own.
  const Mesh mesh = load("v 0 0 0\nv 0 1 0\nv 1 0 0\nv 0 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 4 5 6\n")
                        .parts[0]
                        .mesh;
  CHECK(mesh.normals[0].x == doctest::Approx(mesh.normals[0].z));
}

TEST_CASE("smoothing group 0 is flat") {
  const Mesh mesh = load("s off\n" + std::string(kCube)).parts[0].mesh;
  CHECK(mesh.positions.size() > 8);
  CHECK(normal_agreement(mesh) == doctest::Approx(1.0));
}

TEST_CASE("a smoothing group is smooth in itself and creased to the next") {
  const Mesh mesh = load(
                        "v 0 0 0\nv 0 1 0\nv 1 0 0\nv 0 0 1\nv 0 -1 0\n"
                        "s 1\nf 1 3 2\ns 2\nf 1 2 4\n")
                        .parts[0]
                        .mesh;
  CHECK(normal_agreement(mesh) == doctest::Approx(1.0));
}

TEST_CASE("given normals are kept, at unit length") {
  const Mesh mesh = load(triangle_with("vn 0 0 2\nf 1//1 2//1 3//1\n")).parts[0].mesh;
  CHECK(mesh.normals[0] == glm::vec3{0.0f, 0.0f, 1.0f});
}

TEST_CASE("a face that is wound against its normals is turned round") {
  const Mesh mesh = load(triangle_with("vn 0 0 -1\nf 1//1 2//1 3//1\n")).parts[0].mesh;
  CHECK(mesh.normals[0].z == -1.0f);
  CHECK(area_normal(triangles_of(mesh)[0]).z < 0.0);
}

TEST_CASE("a normal of length 0 is made anew") {
  const Mesh mesh = load(triangle_with("vn 0 0 0\nf 1//1 2//1 3//1\n")).parts[0].mesh;
  CHECK(mesh.normals[0] == glm::vec3{0.0f, 0.0f, 1.0f});
}

TEST_CASE("two sides that cancel each have a normal of their own") {
  // Two triangles that touch in one corner.
  const Mesh mesh = load(triangle_with("v -1 0 0\nv 0 -1 0\nf 1 2 3\nf 1 5 4\n")).parts[0].mesh;
  CHECK(normal_length_error(mesh) < 1e-6);
  CHECK(normal_agreement(mesh) == doctest::Approx(1.0));
}

TEST_CASE("texture coordinates count downwards, and only where there are any") {
  CHECK(load(kCube).parts[0].mesh.uvs.empty());
  const Mesh mesh = load(triangle_with("vt 0.25 0.75\nf 1/1 2/1 3/1\n")).parts[0].mesh;
  REQUIRE(mesh.uvs.size() == 1 * 3);
  CHECK(mesh.uvs[0] == glm::vec2{0.25f, 0.25f});
}

TEST_CASE("triangles without area are left out, and a model of nothing else is refused") {
  CHECK(load(triangle_with("f 1 2 3\nf 1 1 2\n")).parts[0].mesh.indices.size() == 3);
  CHECK(contains(scene_error_of([] { load(triangle_with("f 1 1 2\n")); }), "no face has an area"));
  CHECK(contains(scene_error_of([] { load("v 0 0 0\nv 1e-12 0 0\nv 0 1e-12 0\nf 1 2 3\n"); }),
                 "no face has an area"));
}

TEST_CASE("a model without a library is neutral grey, with no complaint") {
  const Model model = load(kCube);
  CHECK(model.materials[model.parts[0].material].diffuse == glm::vec3{0.5f});
  CHECK(model.warnings.empty());
}

TEST_CASE("a model is split by material, in the order of first use") {
  const Model model = load(triangle_with("v 0 0 1\nmtllib a.mtl\nusemtl blue\nf 1 2 3\nusemtl red\n"
                                         "f 2 3 4\nusemtl blue\nf 3 1 4\n"),
                           "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n");
  REQUIRE(model.parts.size() == 2);
  CHECK(model.materials[model.parts[0].material].name == "blue");
  CHECK(model.materials[model.parts[0].material].diffuse == glm::vec3{0.0f, 0.0f, 1.0f});
  CHECK(model.parts[0].mesh.indices.size() == 6);
  CHECK(model.materials[model.parts[1].material].name == "red");
  CHECK(model.parts[1].mesh.indices.size() == 3);
}

TEST_CASE("a model of 100,000 triangles keeps its triangles and shares its vertices") {
  // A wavy sheet, quadrilaterals with texture coordinates and no normals.
  constexpr int kSide = 224;
  std::string text;
  for (int y = 0; y <= kSide; ++y) {
    for (int x = 0; x <= kSide; ++x) {
      text += "v " + std::to_string(x) + " " + std::to_string((x * 7 + y * 3) % 5) + ".25 " +
              std::to_string(y) + "\nvt " + std::to_string(x) + " 0.5\n";
    }
  }
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      text += "f";
      for (const int corner : {y * (kSide + 1) + x, (y + 1) * (kSide + 1) + x,
                               (y + 1) * (kSide + 1) + x + 1, y * (kSide + 1) + x + 1}) {
        text += " " + std::to_string(corner + 1) + "/" + std::to_string(corner + 1);
      }
      text += "\n";
    }
  }
  const TemporaryDirectory directory;
  write_file(directory.file("a.obj"), text);
  const Model model = load_obj_model(directory.file("a.obj"));
  CHECK(model.parts[0].mesh.indices.size() == 3 * 2 * kSide * kSide);
  CHECK(model.parts[0].mesh.positions.size() == (kSide + 1) * (kSide + 1));
}

TEST_CASE("a library that is named again is not read again, and a material keeps its number") {
  const ObjText obj =
      parse(std::string("mtllib a.mtl\nmtllib b.mtl\nmtllib a.mtl\n") + std::string(kTriangle) +
            "usemtl x\nf 1 2 3\nusemtl y\nf 1 2 3\nusemtl x\nf 2 3 1\n");
  CHECK(obj.libraries == std::vector<std::string>{"a.mtl", "b.mtl"});
  CHECK(obj.material_names == std::vector<std::string>{"x", "y"});
  CHECK(obj.faces[0].material == 0);
  CHECK(obj.faces[1].material == 1);
  CHECK(obj.faces[2].material == 0);
}

// PLY and STL models: the same faces in text and in binary, against numbers by hand and the same
// model as OBJ; and damage.

#include "scenes/models/ply_stl.h"

#include <doctest/doctest.h>

#include <bit>
#include <functional>

#include "raster/numbers/srgb.h"
#include "scenes/load/load_scene.h"
#include "tests/support/scene_test_files.h"

using namespace softfocus;
using namespace softfocus::test;

namespace {

template <class Parse>
std::string complaint_of(Parse parse, const std::string& bytes) {
  return scene_error_of([&] { parse(bytes, "file"); });
}
std::string ply_complaint(const std::string& bytes) { return complaint_of(parse_ply, bytes); }
std::string stl_complaint(const std::string& bytes) { return complaint_of(parse_stl, bytes); }

// Numbers of one kind after the other, of either byte order.
struct Bytes {
  bool is_big = false;
  std::string made{};

  Bytes& add(std::uint64_t bits, int count) {
    for (int i = 0; i < count; ++i) {
      made.push_back(static_cast<char>(bits >> 8 * (is_big ? count - 1 - i : i) & 255));
    }
    return *this;
  }
  Bytes& real(float number) { return add(std::bit_cast<std::uint32_t>(number), 4); }
};

const std::string kVertices =
    "element vertex 4\nproperty float x\nproperty float y\nproperty double z\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty short flags\n";
const std::string kFaces =
    "element edge 1\nproperty int vertex1\nproperty list uchar int more\n"
    "element face 2\nproperty uchar quality\nproperty list uchar uint vertex_indices\nend_header\n";

std::string text_ply() {
  return "ply\nformat ascii 1.0\ncomment a square\n" + kVertices + kFaces +
         "0 0 0.5 255 0 51 -7\n1 0 0.5 255 0 51 -7\n1 1 .5 0 0 0 0\n0 1e0 5e-1 255 255 255 1\n"
         "0 2 8 9\n7 3 0 1 2\n7 3 0 2 3\n";
}

std::string binary_ply(bool is_big) {
  Bytes bytes{is_big};
  const auto vertex = [&](float x, float y, std::array<std::uint64_t, 4> rest) {
    bytes.real(x).real(y).add(std::bit_cast<std::uint64_t>(0.5), 8);
    bytes.add(rest[0], 1).add(rest[1], 1).add(rest[2], 1).add(rest[3], 2);
  };
  vertex(0, 0, {255, 0, 51, 65529});
  vertex(1, 0, {255, 0, 51, 65529});
  vertex(1, 1, {0, 0, 0, 0});
  vertex(0, 1, {255, 255, 255, 1});
  bytes.add(0, 4).add(2, 1).add(8, 4).add(9, 4);
  for (const std::array<std::uint64_t, 3> of : {std::array<std::uint64_t, 3>{0, 1, 2}, {0, 2, 3}}) {
    bytes.add(7, 1).add(3, 1);
    for (const std::uint64_t index : of) bytes.add(index, 4);
  }
  return std::string{"ply\nformat binary_"} + (is_big ? "big" : "little") + "_endian 1.0\n" +
         kVertices + kFaces + bytes.made;
}

const std::string kFacet =
    "facet normal 0 0 0\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 2.5 0\n"
    " endloop\nendfacet\n";

std::string binary_stl(const std::string& text, float last = 2.5f) {
  Bytes bytes;
  bytes.made = text;
  bytes.made.resize(80, ' ');
  bytes.add(1, 4);
  for (const int number : {0, 0, -1, 0, 0, 0, 1, 0, 0, 0}) bytes.real(static_cast<float>(number));
  bytes.real(last).real(0).add(0x8123, 2);
  return bytes.made;
}

void check_same(const ObjText& a, const ObjText& b) {
  CHECK(a.positions == b.positions);
  CHECK(a.colours == b.colours);
  CHECK(a.uvs == b.uvs);
  CHECK(a.normals == b.normals);
  REQUIRE(a.corners.size() == b.corners.size());
  for (std::size_t i = 0; i < a.corners.size(); ++i) {
    CHECK(a.corners[i].position == b.corners[i].position);
    CHECK(a.corners[i].uv == b.corners[i].uv);
    CHECK(a.corners[i].normal == b.corners[i].normal);
  }
  CHECK(a.faces.size() == b.faces.size());
}

// Each beginning of a file, and each byte as some others.
void damage(const std::string& bytes, const std::function<void(const std::string&)>& read) {
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    read(bytes.substr(0, i));
    for (const char to : {'\0', ' ', '9', '\xff', '\n'}) {
      std::string other = bytes;
      other[i] = to;
      read(other);
    }
  }
}

}  // namespace

// What 51 of 255 is along the sRGB curve.
const float kRed = srgb8_to_linear(51);

TEST_CASE("PLY in text and in binary of either byte order has the same faces") {
  const FileFaces text = parse_ply(text_ply(), "file");
  CHECK(text.faces.positions ==
        std::vector<glm::vec3>{{0, 0, 0.5f}, {1, 0, 0.5f}, {1, 1, 0.5f}, {0, 1, 0.5f}});
  CHECK(text.faces.colours ==
        std::vector<glm::vec3>{{1, 0, kRed}, {1, 0, kRed}, {0, 0, 0}, {1, 1, 1}});
  CHECK(text.faces.corners[4].position == 2);
  CHECK(text.faces.corners[4].normal == -1);
  CHECK(text.faces.faces.size() == 2);
  CHECK(text.faces.warnings.empty());
  for (const bool is_big : {false, true}) {
    check_same(parse_ply(binary_ply(is_big), "file").faces, text.faces);
  }
  std::string returns;
  for (const char c : text_ply()) returns += c == '\n' ? std::string{"\r\n"} : std::string{c};
  check_same(parse_ply(returns, "file").faces, text.faces);
}

TEST_CASE("PLY's rows may have more on their line, lie on several lines, or several on one") {
  const ObjText right = parse_ply(text_ply(), "file").faces;
  std::string more = text_ply(), one_line = text_ply(), spread = text_ply();
  more.replace(more.find("7 3 0 1 2\n"), 10, "7 3 0 1 2 9 1 1\n");
  check_same(parse_ply(more, "file").faces, right);
  for (std::size_t i = one_line.find("end_header") + 11; i + 1 < one_line.size(); ++i) {
    if (one_line[i] == '\n') one_line[i] = ' ';
    if (spread[i] == ' ') spread[i] = '\n';
  }
  check_same(parse_ply(one_line, "file").faces, right);
  check_same(parse_ply(spread, "file").faces, right);
}

TEST_CASE("PLY's normals, coordinates of vertices and of corners, strips and polygons") {
  const std::string header =
      "ply\nformat ascii 1.0\ncomment TextureFile a b.png\nelement vertex 4\nproperty float x\n"
      "property float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float "
      "nz\n"
      "property float texture_u\nproperty float texture_v\n";
  const std::string vertices =
      "0 0 0 0 0 2 .5 0\n1 0 0 0 0 nan .25 1\n1 1 0 0 0 1 9e9 0\n"
      "0 1 0 0 0 1 0 0\n";
  const FileFaces polygon =
      parse_ply(header + "element face 2\nproperty list uchar int vertex_index\nend_header\n" +
                    vertices + "4 0 1 2 3\n2 0 1\n",
                "file");
  CHECK(polygon.texture == "a b.png");
  CHECK(polygon.faces.faces.size() == 1);
  CHECK(polygon.faces.faces[0].corner_count == 4);
  CHECK(polygon.faces.corners[1].uv == 1);
  CHECK(polygon.faces.corners[1].normal == 1);
  CHECK(polygon.faces.normals[0] == glm::vec3{0, 0, 2});
  CHECK(polygon.faces.normals[1] == glm::vec3{0});
  CHECK(polygon.faces.uvs[1] == glm::vec2{0.25f, 1.0f});
  CHECK(polygon.faces.warnings ==
        std::vector<std::string>{"file: 1 faces of fewer than three corners are left out",
                                 "file: 1 texture coordinates are out of range, or none, and 0"});
  const FileFaces wedges = parse_ply(header +
                                         "element face 2\nproperty list uchar int vertex_indices\n"
                                         "property list uchar float texcoord\nend_header\n" +
                                         vertices + "3 0 1 2 6 0 1 .5 .5 1 0\n3 0 1 3 0\n",
                                     "file");
  const ObjText& w = wedges.faces;
  CHECK(w.uvs[static_cast<std::size_t>(w.corners[4].uv)] == glm::vec2{0.25f, 1.0f});
  CHECK(w.uvs[static_cast<std::size_t>(w.corners[1].uv)] == glm::vec2{0.5f});
  CHECK(w.uvs[static_cast<std::size_t>(w.corners[2].uv)] == glm::vec2{1.0f, 0.0f});
  const FileFaces strips =
      parse_ply(header + "element tristrips 1\nproperty list int int vertex_indices\nend_header\n" +
                    vertices + "8 0 1 3 2 -1 0 1 2\n",
                "file");
  std::vector<int> order;
  for (const ObjCorner& corner : strips.faces.corners) order.push_back(corner.position);
  CHECK(order == std::vector<int>{0, 1, 3, 3, 1, 2, 0, 1, 2});
}

TEST_CASE("STL in text and in binary has the same flat facets, normals or not") {
  const FileFaces text = parse_stl("solid my vertex holder\n" + kFacet + "endsolid\n", "file");
  CHECK(text.faces.positions == std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 2.5f, 0}});
  CHECK(text.faces.normals.empty());
  CHECK(text.faces.has_smoothing_groups);
  check_same(parse_stl(binary_stl("made by hand"), "file").faces, text.faces);
  check_same(parse_stl(binary_stl("solid as some begin"), "file").faces, text.faces);
  check_same(parse_stl(binary_stl("made by hand") + "more", "file").faces, text.faces);
  check_same(parse_stl(binary_stl("solid as some begin") + "more", "file").faces, text.faces);
  std::string line = "solid one " + kFacet + "endsolid one";
  for (char& c : line) c = c == '\n' ? '\r' : c;
  check_same(parse_stl(line, "file").faces, text.faces);
  std::string odd = "\xEF\xBB\xBFsolid\n# a comment of vertex 1\ncolor 1 0 0\n" + kFacet;
  odd.replace(odd.find("endloop"), 7, "END LOOP");
  odd +=
      "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex nan 0 0\nvertex 1 0 0\nendloop\n"
      "endfacet\n" +
      kFacet;
  const FileFaces less = parse_stl(odd, "file");
  CHECK(less.faces.faces.size() == 2);
  CHECK(less.faces.positions.size() == 6);
  CHECK(less.faces.faces[1].corner_count == 3);
  CHECK(less.faces.warnings.at(0) ==
        "file: 1 facets with a coordinate that is no number, or beyond 1e9, are left out");
  const FileFaces two =
      parse_stl("SOLID a\r\n" + kFacet + "endsolid a\nsolid b\n" + kFacet, "file");
  CHECK(two.faces.faces.size() == 2);
  CHECK(two.faces.faces[1].first_corner == 3);
}

TEST_CASE("a model is the same scene as PLY, STL and OBJ, flat where STL is") {
  const TemporaryDirectory directory;
  write_file(directory.file("a.ply"), text_ply());
  std::string obj =
      "v 0 0 .5 1 0 C\nv 1 0 .5 1 0 C\nv 1 1 .5 0 0 0\nv 0 1 .5 1 1 1\nf 1 2 3\nf 1 3 4\n";
  for (std::size_t at = obj.find('C'); at != obj.npos; at = obj.find('C')) {
    obj.replace(at, 1, "0.033104766");
  }
  write_file(directory.file("a.obj"), obj);
  const Scene ply = load_scene(directory.file("a.ply"), {});
  const Scene same = load_scene(directory.file("a.obj"), {});
  REQUIRE(ply.meshes.size() == 1);
  CHECK(ply.meshes[0].positions == same.meshes[0].positions);
  CHECK(ply.meshes[0].normals == same.meshes[0].normals);
  CHECK(ply.meshes[0].colours == same.meshes[0].colours);
  CHECK(ply.meshes[0].indices == same.meshes[0].indices);
  CHECK(ply.camera.position == same.camera.position);

  // A tent: smooth in PLY, flat in STL.
  const std::string tent =
      "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
      "vertex 0 1 1\nendloop\nendfacet\nfacet normal 0 0 0\nouter loop\n"
      "vertex 0 0 0\nvertex 0 1 1\nvertex -1 0 0.5\nendloop\nendfacet\n";
  write_file(directory.file("b.stl"), "solid\n" + tent + "endsolid\n");
  const Scene stl = load_scene(directory.file("b.stl"), {});
  const Mesh& mesh = stl.meshes.at(0);
  CHECK(mesh.indices.size() == 6);
  CHECK(mesh.normals[mesh.indices[0]] == mesh.normals[mesh.indices[2]]);
  CHECK(mesh.normals[mesh.indices[0]] != mesh.normals[mesh.indices[3]]);
}

TEST_CASE("PLY's colours of every type") {
  const auto colours = [](const std::string& type, const std::string& first,
                          const std::string& second) {
    const std::string of = "property " + type + " ";
    return parse_ply(
               "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
               "property float z\n" +
                   of + "r\n" + of + "g\n" + of + "b\n" +
                   "element face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0 " +
                   first + "\n1 0 0 " + second + "\n0 1 0 0 0 0\n3 0 1 2\n",
               "file")
        .faces;
  };
  for (const char* type : {"uchar", "short", "ushort", "int"}) {
    const ObjText bytes = colours(type, "255 51 -1", "1 2 3");
    CHECK(bytes.colours[0] == glm::vec3{1.0f, kRed, 0.0f});
    CHECK(bytes.warnings.empty());
  }
  CHECK(colours("ushort", "65535 13107 0", "1 2 3").colours[0] == glm::vec3{1.0f, kRed, 0.0f});
  const ObjText lit = colours("float", "1.25 .5 nan", "0 0 .25");
  CHECK(lit.colours[0] == glm::vec3{1.0f, 0.5f, 0.0f});
  CHECK(lit.warnings.empty());
  CHECK(colours("float", "510 51 0", "0 0 0").colours[0] == glm::vec3{1.0f, 0.2f, 0.0f});
  const ObjText bright = colours("double", "255 51 0", "0 0 0");
  CHECK(bright.colours[0] == glm::vec3{1.0f, 0.2f, 0.0f});
  CHECK(bright.warnings.at(0) == "file: colours beyond 1: they are taken for 0 to 255");
}

TEST_CASE("a PLY's picture is its texture, or told to be missing") {
  const TemporaryDirectory directory;
  std::string text = text_ply();
  text.replace(text.find("a square"), 8, "TextureFile red-blue-16x8.jpg");
  write_file(directory.file("a.ply"), text);
  const Scene without = load_scene(directory.file("a.ply"), {});
  CHECK(without.textures.empty());
  CHECK(without.warnings.at(0).ends_with("texture red-blue-16x8.jpg is missing"));
  std::filesystem::copy_file(SOFTFOCUS_TEST_DATA "/red-blue-16x8.jpg",
                             directory.file("red-blue-16x8.jpg"));
  const Scene textured = load_scene(directory.file("a.ply"), {});
  REQUIRE(textured.textures.size() == 1);
  CHECK(textured.materials[textured.objects[0].material].texture == 0);
  CHECK(textured.materials[textured.objects[0].material].diffuse == glm::vec3{1.0f});
}

TEST_CASE("positions far from the origin keep their bits") {
  std::string text = text_ply();
  for (const char* name : {"property float x", "property float y"}) {
    text.replace(text.find(name), 14, "property double");
  }
  text.replace(text.find("0 0 0.5"), 7, "1000000.125 0 0.5");
  text.replace(text.find("1 0 0.5"), 7, "1000001.5 0 0.5");
  text.replace(text.find("1 1 .5"), 6, "1000001.5 1 .5");
  text.replace(text.find("0 1e0"), 5, "1000000.0625 1e0");
  const FileFaces far = parse_ply(text, "file");
  CHECK(far.origin.x == 1000001.0);
  CHECK(far.faces.positions[3].x == -0.9375f);
}

TEST_CASE("what is no PLY is refused, and where") {
  CHECK(ply_complaint("obj\n") == "file:1: is no PLY: the first line is not \"ply\"");
  CHECK(ply_complaint("ply\nformat ascii 1.0\n") ==
        "file:3: the header has no end; end_header is missing");
  CHECK(ply_complaint("ply\nend_header\n") == "file:2: the header has no format");
  CHECK(
      ply_complaint("ply\nformat binary 1.0\nend_header\n") ==
      "file:2: \"binary\" is no format; ascii, binary_little_endian or binary_big_endian would be "
      "right");
  CHECK(ply_complaint("ply\nformat ascii 1.0\nelement vertex many\nend_header\n") ==
        "file:3: an element's count is no whole number");
  CHECK(ply_complaint("ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\nend_header\n")
            .starts_with("file:4: \"half\" is no type;"));
  const std::string text = text_ply();
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string other = text;
    other.replace(other.find(from), from.size(), to);
    return ply_complaint(other);
  };
  CHECK(with("1 1 .5", "1 x .5") == "file:21: vertex 2 has \"x\", which is no number");
  CHECK(with("1 1 .5", "1 inf .5") ==
        "file: a face has vertex 2, whose place is no number, or beyond 1e9");
  std::string unused = text;
  unused.replace(unused.find("vertex 4"), 8, "vertex 5");
  unused.insert(unused.find("0 2 8 9"), "nan nan nan 1 2 3 0\n");
  CHECK(parse_ply(unused, "file").faces.positions.at(4) == glm::vec3{0.0f});
  CHECK(with("7 3 0 2 3", "7 3 0 2") == "file:26: face 1 is missing: the file is cut off");
  CHECK(with("7 3 0 2 3", "7 3 0 2 4") == "file: a face has vertex 4 of 4");
  CHECK(with("7 3 0 2 3", "7 3 0 2 -1") == "file:25: face 1 has an index that is none");
  CHECK(with("element face 2", "element point 2") ==
        "file: has no faces; points alone cannot be drawn, a mesh would be right");
  CHECK(with("vertex_indices", "corners") == "file: its faces have no list vertex_indices");
  std::string mixed = text;
  for (std::size_t at = mixed.find("\nelement"); at != mixed.npos;
       at = mixed.find("\nelement", at + 2)) {
    mixed.insert(at, "\r");
  }
  CHECK(parse_ply(mixed, "file").faces.faces.size() == 2);
  CHECK(with("float y", "float height") == "file: the vertices have no x, y and z");
  std::string binary = binary_ply(false);
  binary.pop_back();
  CHECK(ply_complaint(binary) == "file: face 1 is missing: the file is cut off");
}

TEST_CASE("what is no STL is refused, and where") {
  CHECK(stl_complaint("") ==
        "file: is no STL, or cut off: 0 bytes where 84 for 0 facets would be "
        "right");
  CHECK(stl_complaint(binary_stl("a").substr(0, 130)) ==
        "file: is no STL, or cut off: 130 bytes where 134 for 1 facets would be right");
  CHECK(stl_complaint(binary_stl("a", 2e9f)) == "file: has no facets; a mesh would be right");
  CHECK(stl_complaint(binary_stl("solid a").substr(0, 130)) ==
        "file: is no STL, or cut off: 130 bytes where 134 for 1 facets would be right");
  CHECK(stl_complaint("solid\nendsolid\n") == "file: has no facets; a mesh would be right");
  CHECK(stl_complaint("solid\nfacet normal 0 0 1\nvertex 0 0\nendfacet") ==
        "file:4: \"endfacet\" is no number");
  CHECK(stl_complaint("solid\nfacet normal 0 0 1\nvertex 0 0 1\nendfacet") ==
        "file:4: a facet of fewer than three vertices");
  CHECK(stl_complaint("solid\n" + kFacet + "facet\n") == "file:10: the file ends within a facet");
  CHECK(stl_complaint("solid\nvertex 0 0 1") == "file:2: a vertex outside a facet");
  CHECK(stl_complaint("solid\nface").starts_with("file:2: \"face\" is unknown;"));
}

TEST_CASE("damaged PLY and STL files are read or refused") {
  std::size_t refused = 0, read = 0;
  const auto try_with = [&](auto parse) {
    return [&, parse](const std::string& bytes) {
      try {
        parse(bytes, std::string{"file"});
        ++read;
      } catch (const SceneError&) {
        ++refused;
      }
    };
  };
  const auto as_ply =
      try_with([](const std::string& bytes, const std::string& file) { parse_ply(bytes, file); });
  const auto as_stl =
      try_with([](const std::string& bytes, const std::string& file) { parse_stl(bytes, file); });
  damage(text_ply(), as_ply);
  damage(binary_ply(false), as_ply);
  damage(binary_ply(true), as_ply);
  damage("solid\n" + kFacet + "endsolid\n", as_stl);
  damage(binary_stl("binary"), as_stl);
  CHECK(refused > 3000);
  CHECK(read > 300);
}

// The OBJ reader against tinyobjloader's, on models that both take.

#include <doctest/doctest.h>
#include <tiny_obj_loader.h>

#include <sstream>
#include <string>

#include "scenes/models/obj_text.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

// A random soup of polygons of 3 to 6 corners, with every form of index.
std::string random_model(std::uint64_t seed) {
  Random random{seed};
  const auto below = [&](int n) {
    return static_cast<int>(random.next() % static_cast<unsigned>(n));
  };
  constexpr int kPoints = 40;
  std::string text = "# a comment\no thing\ns 1\n";
  for (int i = 0; i < kPoints; ++i) {
    for (const char* kind : {"v", "vn"}) {
      text += kind;
      for (int axis = 0; axis < 3; ++axis) text += " " + std::to_string(below(20000) / 1000.0 - 10);
      text += "\n";
    }
    text +=
        "vt " + std::to_string(below(1000) / 1000.0) + " " + std::to_string(below(1000) / 1000.0);
    text += "\n";
  }
  for (int face = 0; face < 60; ++face) {
    text += "f";
    const int form = below(4);
    const int corners = 3 + below(4);
    for (int corner = 0; corner < corners; ++corner) {
      const auto index = [&] {
        const int i = below(kPoints);
        return std::to_string(below(2) == 0 ? i + 1 : i - kPoints);
      };
      text += " " + index();
      if (form == 1) text += "/" + index();
      if (form == 2) text += "//" + index();
      if (form == 3) text += "/" + index() + "/" + index();
    }
    text += "\n";
  }
  return text;
}

}  // namespace

TEST_CASE("the OBJ reader reads what tinyobjloader reads") {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const std::string text = random_model(seed);
    const ObjText ours = parse_obj_text(text, "random.obj");

    tinyobj::attrib_t attributes;
    std::vector<tinyobj::shape_t> shapes;
    std::vector<tinyobj::material_t> materials;
    std::string warnings;
    std::string errors;
    std::istringstream stream(text);
    REQUIRE(tinyobj::LoadObj(&attributes, &shapes, &materials, &warnings, &errors, &stream, nullptr,
                             false));
    REQUIRE(shapes.size() == 1);
    const tinyobj::mesh_t& mesh = shapes[0].mesh;

    REQUIRE(ours.positions.size() * 3 == attributes.vertices.size());
    for (std::size_t i = 0; i < attributes.vertices.size(); ++i) {
      // tinyobjloader's decimals may be off in the last bit.
      CHECK(ours.positions[i / 3][static_cast<int>(i % 3)] ==
            doctest::Approx(attributes.vertices[i]).epsilon(1e-6));
      CHECK(ours.normals[i / 3][static_cast<int>(i % 3)] ==
            doctest::Approx(attributes.normals[i]).epsilon(1e-6));
    }
    REQUIRE(ours.faces.size() == mesh.num_face_vertices.size());
    REQUIRE(ours.corners.size() == mesh.indices.size());
    for (std::size_t f = 0; f < ours.faces.size(); ++f) {
      CHECK(ours.faces[f].corner_count == mesh.num_face_vertices[f]);
    }
    for (std::size_t c = 0; c < ours.corners.size(); ++c) {
      CHECK(ours.corners[c].position == mesh.indices[c].vertex_index);
      CHECK(ours.corners[c].uv == mesh.indices[c].texcoord_index);
      CHECK(ours.corners[c].normal == mesh.indices[c].normal_index);
    }
  }
}

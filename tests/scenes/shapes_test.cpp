#include "scenes/make/shapes.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "raster/numbers/exact_math.h"
#include "tests/support/mesh_checks.h"

using namespace softfocus;
using namespace softfocus::test;

namespace {

constexpr double kPi = exact_math::kPi;

struct ClosedShape {
  const char* name;
  Mesh mesh;
  long euler;
  std::size_t triangles;
  double area;
  double volume;
};

// Odd counts among them, where a seam is most easily missed.
std::vector<ClosedShape> closed_shapes() {
  return {
      {"sphere", make_sphere(2.0, 96, 48), 2, 2 * 96 * 47, 16 * kPi, 32.0 / 3.0 * kPi},
      {"torus", make_torus(3.0, 1.0, 96, 64), 0, 2 * 96 * 64, 12 * kPi * kPi, 6 * kPi * kPi},
      {"cone", make_cone(3.0, 4.0, 128, 7), 2, 2 * 128 * 7, 24 * kPi, 12 * kPi},
      {"cube", make_cube(3.0, 7), 2, 12 * 49, 54, 27},
      {"coarse sphere", make_sphere(1.0, 3, 2), 2, 6, 0, 0},
      {"coarse torus", make_torus(1.0, 0.5, 3, 3), 0, 18, 0, 0},
      {"coarse cone", make_cone(1.0, 1.0, 3, 1), 2, 6, 0, 0},
      {"coarse cube", make_cube(1.0, 1), 2, 12, 6, 1},
      {"odd sphere", make_sphere(0.37, 37, 23), 2, 2 * 37 * 22, 0, 0},
      {"odd torus", make_torus(0.7, 0.21, 41, 19), 0, 2 * 41 * 19, 0, 0},
  };
}

}  // namespace

TEST_CASE("sphere, torus, cone and cube are closed: each edge has two triangles") {
  for (const ClosedShape& shape : closed_shapes()) {
    CAPTURE(shape.name);
    CHECK(is_closed(weld(shape.mesh)));
  }
}

TEST_CASE("a torus has one hole, the other shapes have none") {
  for (const ClosedShape& shape : closed_shapes()) {
    CAPTURE(shape.name);
    CHECK(euler_characteristic(weld(shape.mesh)) == shape.euler);
  }
}

TEST_CASE("a shape has as many triangles as its docstring says, none without area") {
  for (const ClosedShape& shape : closed_shapes()) {
    CAPTURE(shape.name);
    CHECK(shape.mesh.indices.size() == 3 * shape.triangles);
    CHECK(smallest_area(shape.mesh) > 1e-6);
  }
}

TEST_CASE("triangles are counter-clockwise from outside: volumes are positive") {
  for (const ClosedShape& shape : closed_shapes()) {
    CAPTURE(shape.name);
    CHECK(volume(shape.mesh) > 0.0);
  }
}

TEST_CASE("areas and volumes come near those of the round shapes, from below") {
  for (const ClosedShape& shape : closed_shapes()) {
    if (shape.area == 0.0) continue;
    CAPTURE(shape.name);
    CHECK(area(shape.mesh) == doctest::Approx(shape.area).epsilon(0.005));
    CHECK(volume(shape.mesh) == doctest::Approx(shape.volume).epsilon(0.005));
    CHECK(area(shape.mesh) <= shape.area * 1.000001);
    CHECK(volume(shape.mesh) <= shape.volume * 1.000001);
  }
}

TEST_CASE("normals have unit length, one a vertex, and there is a uv for each") {
  for (const ClosedShape& shape : closed_shapes()) {
    CAPTURE(shape.name);
    CHECK(normal_length_error(shape.mesh) < 2e-7);
    CHECK(shape.mesh.normals.size() == shape.mesh.positions.size());
    CHECK(shape.mesh.uvs.size() == shape.mesh.positions.size());
  }
}

TEST_CASE("a sphere's normals point outwards") {
  const Mesh mesh = make_sphere(2.5, 48, 24);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::vec3 expected = mesh.positions[i] * 0.4f;
    CHECK(length(glm::dvec3{mesh.normals[i] - expected}) < 1e-6);
  }
}

TEST_CASE("normals lie near the triangles' own") {
  CHECK(normal_agreement(make_sphere(1.0, 64, 32)) > 0.99);
  CHECK(normal_agreement(make_torus(1.0, 0.3, 64, 32)) > 0.98);
  CHECK(normal_agreement(make_cone(0.5, 1.0, 64, 8)) > 0.99);
  CHECK(normal_agreement(make_cube(1.0, 4)) == doctest::Approx(1.0));
  CHECK(normal_agreement(make_plane(1.0, 2.0, 3, 5)) == doctest::Approx(1.0));
}

TEST_CASE("points on the axes are exact") {
  const Mesh mesh = make_sphere(0.3f, 8, 4);
  float top = 0.0f;
  for (const glm::vec3& p : mesh.positions) top = std::max(top, p.y);
  CHECK(top == 0.3f);
  CHECK(std::count(mesh.positions.begin(), mesh.positions.end(), glm::vec3{0.3f, 0.0f, 0.0f}) == 1);
}

TEST_CASE("a cone stands on the ground with its tip above the middle") {
  const Mesh mesh = make_cone(0.5, 2.0, 16, 4);
  for (const glm::vec3& p : mesh.positions) {
    CHECK(p.y >= 0.0f);
    CHECK(p.y <= 2.0f);
  }
  CHECK(std::count(mesh.positions.begin(), mesh.positions.end(), glm::vec3{0.0f, 2.0f, 0.0f}) ==
        16);
}

TEST_CASE("a plane faces up and has two triangles a cell") {
  const Mesh mesh = make_plane(4.0, 2.0, 28, 30);
  CHECK(mesh.indices.size() == 3 * 1680);
  CHECK(area(mesh) == doctest::Approx(8.0));
  for (const MeshTriangle& t : triangles_of(mesh)) CHECK(area_normal(t).y > 0.0);
}

TEST_CASE("a plane's four sides are its only boundary") {
  const Welded welded = weld(make_plane(4.0, 2.0, 5, 7));
  CHECK(welded.open_edges.size() == 2 * (5 + 7));
  CHECK(boundary_loops(welded) == 1);
}

TEST_CASE("seen from outside, a texture is not mirrored") {
  // d(position)/du x d(position)/dv points inwards where u runs right and v runs down.
  const Mesh shapes[] = {make_sphere(1.0, 24, 12), make_torus(1.0, 0.3, 24, 12), make_cube(1.0, 2),
                         make_plane(1.0, 1.0, 2, 2)};
  for (const Mesh& mesh : shapes) {
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
      const glm::dvec2 a{mesh.uvs[mesh.indices[i]]};
      const glm::dvec2 ab = glm::dvec2{mesh.uvs[mesh.indices[i + 1]]} - a;
      const glm::dvec2 ac = glm::dvec2{mesh.uvs[mesh.indices[i + 2]]} - a;
      // Counter-clockwise on the surface is clockwise in (u, v) with v down.
      CHECK(ab.x * ac.y - ab.y * ac.x < 0.0);
    }
  }
}

TEST_CASE("inside out, a cube faces its middle, and its volume is negative") {
  const Mesh room = inside_out(make_cube(2.0, 3));
  CHECK(volume(room) == doctest::Approx(-8.0));
  CHECK(is_closed(weld(room)));
  CHECK(normal_agreement(room) == doctest::Approx(1.0));
}

TEST_CASE("inside out twice is the shape itself") {
  const Mesh cube = make_cube(2.0, 2);
  const Mesh twice = inside_out(inside_out(cube));
  CHECK(twice.indices == cube.indices);
  CHECK(twice.normals == cube.normals);
  CHECK(twice.uvs == cube.uvs);
}

TEST_CASE("repeated, a texture's coordinates reach as far as it repeats") {
  Mesh mesh = make_plane(1.0, 1.0, 2, 2);
  repeat_uvs(mesh, {3.0, 5.0});
  glm::vec2 largest{0.0f};
  for (const glm::vec2& uv : mesh.uvs) {
    largest = {std::max(largest.x, uv.x), std::max(largest.y, uv.y)};
  }
  CHECK(largest == glm::vec2{3.0f, 5.0f});
}

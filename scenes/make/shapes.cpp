#include "scenes/make/shapes.h"

#include <array>
#include <cassert>
#include <cmath>

#include "raster/numbers/exact_math.h"
#include "raster/numbers/vector_math.h"
#include "scenes/make/grid_mesh.h"

namespace softfocus {
namespace {

using exact_math::cos_degrees;
using exact_math::sin_degrees;

// The horizontal direction at a column of a full turn; +z first, then +x. The last
// column has the bits of the first: 360 degrees reduce to 0 exactly.
glm::dvec3 heading(double column, int columns) {
  const double degrees = 360.0 * column / columns;
  return {sin_degrees(degrees), 0.0, cos_degrees(degrees)};
}

// -0.5 to 0.5 over the cells; opposite places differ in sign alone, so that faces
// that meet agree to the bit.
double centred(double place, int cells) { return (2.0 * place - cells) / (2.0 * cells); }

constexpr glm::dvec3 kUp{0.0, 1.0, 0.0};

}  // namespace

Mesh make_sphere(double radius, int segments, int rings) {
  assert(radius > 0.0 && segments >= 3 && rings >= 2);
  Mesh mesh;
  append_grid(mesh, {segments, rings, true, true}, [&](double column, int row) {
    const double from_pole = 180.0 * row / rings;
    const glm::dvec3 out =
        heading(column, segments) * sin_degrees(from_pole) + kUp * cos_degrees(from_pole);
    return SurfacePoint{out * radius, out, {column / segments, static_cast<double>(row) / rings}};
  });
  return mesh;
}

Mesh make_torus(double ring_radius, double tube_radius, int segments, int sides) {
  assert(tube_radius > 0.0 && tube_radius < ring_radius && segments >= 3 && sides >= 3);
  Mesh mesh;
  append_grid(mesh, {segments, sides}, [&](double column, int row) {
    const double around_tube = 360.0 * row / sides;
    const glm::dvec3 ring = heading(column, segments);
    const glm::dvec3 out = ring * sin_degrees(around_tube) + kUp * cos_degrees(around_tube);
    return SurfacePoint{ring * ring_radius + out * tube_radius,
                        out,
                        {column / segments, static_cast<double>(row) / sides}};
  });
  return mesh;
}

Mesh make_cone(double radius, double height, int segments, int rings) {
  assert(radius > 0.0 && height > 0.0 && segments >= 3 && rings >= 1);
  const double slant = std::sqrt(radius * radius + height * height);
  Mesh mesh;
  append_grid(mesh, {segments, rings, true, false}, [&](double column, int row) {
    const double down = static_cast<double>(row) / rings;
    const glm::dvec3 out = heading(column, segments);
    return SurfacePoint{out * (radius * down) + kUp * (height * (rings - row) / rings),
                        (out * height + kUp * radius) / slant,
                        {column / segments, down}};
  });
  append_grid(mesh, {segments, 1, false, true}, [&](double column, int row) {
    const glm::dvec3 rim = row == 0 ? heading(column, segments) : glm::dvec3{0.0};
    return SurfacePoint{rim * radius, -kUp, {0.5 + 0.5 * rim.x, 0.5 - 0.5 * rim.z}};
  });
  return mesh;
}

Mesh make_cube(double size, int cells) {
  assert(size > 0.0 && cells >= 1);
  struct Face {
    glm::dvec3 outward;
    glm::dvec3 right;
    glm::dvec3 up;
  };
  // outward = right x up
  static constexpr std::array<Face, 6> kFaces = {{
      {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}},
      {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}},
      {{0, 0, -1}, {-1, 0, 0}, {0, 1, 0}},
      {{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
      {{0, 1, 0}, {1, 0, 0}, {0, 0, -1}},
      {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}},
  }};
  Mesh mesh;
  for (const Face& face : kFaces) {
    append_grid(mesh, {cells, cells}, [&](double column, int row) {
      const glm::dvec3 place =
          face.outward * 0.5 + face.right * centred(column, cells) - face.up * centred(row, cells);
      return SurfacePoint{
          place * size, face.outward, {column / cells, static_cast<double>(row) / cells}};
    });
  }
  return mesh;
}

Mesh make_plane(double width, double depth, int cells_x, int cells_z) {
  assert(width > 0.0 && depth > 0.0 && cells_x >= 1 && cells_z >= 1);
  Mesh mesh;
  append_grid(mesh, {cells_x, cells_z}, [&](double column, int row) {
    return SurfacePoint{{centred(column, cells_x) * width, 0.0, centred(row, cells_z) * depth},
                        kUp,
                        {column / cells_x, static_cast<double>(row) / cells_z}};
  });
  return mesh;
}

Mesh inside_out(Mesh mesh) {
  for (glm::vec3& normal : mesh.normals) normal = -normal;
  for (glm::vec2& uv : mesh.uvs) uv.x = 1.0f - uv.x;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
  }
  return mesh;
}

void repeat_uvs(Mesh& mesh, glm::dvec2 times) {
  for (glm::vec2& uv : mesh.uvs) uv = glm::vec2{glm::dvec2{uv} * times};
}

}  // namespace softfocus

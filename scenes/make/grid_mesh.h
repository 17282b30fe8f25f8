#pragma once
// How every shape here is made: a grid of points on a surface, cells cut into two
// triangles. Seen from outside, columns run to the right and rows run down, as the
// texels of a picture do.

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "scenes/scene.h"

namespace softfocus {

/// A point of a surface in binary64; the mesh holds it rounded once.
struct SurfacePoint {
  glm::dvec3 position{0.0};
  glm::dvec3 normal{0.0, 1.0, 0.0};  ///< unit length
  glm::dvec2 uv{0.0};
};

/// How many cells, and whether the first or last row shrinks to a point.
struct GridLayout {
  int columns = 1;
  int rows = 1;
  bool first_row_is_point = false;
  bool last_row_is_point = false;
};

inline void append_vertex(Mesh& mesh, const SurfacePoint& point) {
  mesh.positions.emplace_back(point.position);
  mesh.normals.emplace_back(point.normal);
  mesh.uvs.emplace_back(point.uv);
}

/// Adds the grid to the mesh. `point(column, row)` gives a SurfacePoint for column 0
/// to columns and row 0 to rows. A row that is a point has a vertex for each column's
/// middle (column + 0.5), so that its triangles have a uv and a normal each and none
/// is without area.
template <class PointFunction>
void append_grid(Mesh& mesh, const GridLayout& layout, PointFunction point) {
  const auto first_vertex = static_cast<std::uint32_t>(mesh.positions.size());
  const auto columns = static_cast<std::uint32_t>(layout.columns);
  for (int row = 0; row <= layout.rows; ++row) {
    const bool is_point =
        (row == 0 && layout.first_row_is_point) || (row == layout.rows && layout.last_row_is_point);
    const int vertices = is_point ? layout.columns : layout.columns + 1;
    for (int column = 0; column < vertices; ++column) {
      append_vertex(mesh, point(is_point ? column + 0.5 : column, row));
    }
  }

  std::uint32_t upper = first_vertex;
  for (int row = 0; row < layout.rows; ++row) {
    const bool upper_is_point = row == 0 && layout.first_row_is_point;
    const bool lower_is_point = row == layout.rows - 1 && layout.last_row_is_point;
    const std::uint32_t lower = upper + columns + (upper_is_point ? 0 : 1);
    for (std::uint32_t i = 0; i < columns; ++i) {
      if (!lower_is_point) {
        mesh.indices.insert(mesh.indices.end(), {upper + i, lower + i, lower + i + 1});
      }
      if (!upper_is_point) {
        const std::uint32_t corner = lower_is_point ? lower + i : lower + i + 1;
        mesh.indices.insert(mesh.indices.end(), {upper + i, corner, upper + i + 1});
      }
    }
    upper = lower;
  }
}

}  // namespace softfocus

#pragma once
// Claims that hold for any triangle mesh.

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/vec3.hpp>
#include <map>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "raster/numbers/vector_math.h"
#include "scenes/scene.h"

namespace softfocus::test {

using MeshTriangle = std::array<glm::dvec3, 3>;

inline std::vector<MeshTriangle> triangles_of(const Mesh& mesh) {
  std::vector<MeshTriangle> triangles;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    triangles.push_back({glm::dvec3{mesh.positions[mesh.indices[i]]},
                         glm::dvec3{mesh.positions[mesh.indices[i + 1]]},
                         glm::dvec3{mesh.positions[mesh.indices[i + 2]]}});
  }
  return triangles;
}

inline glm::dvec3 area_normal(const MeshTriangle& t) { return cross(t[1] - t[0], t[2] - t[0]); }

inline double length(glm::dvec3 v) { return std::sqrt(dot(v, v)); }

inline double area(const Mesh& mesh) {
  double sum = 0.0;
  for (const MeshTriangle& t : triangles_of(mesh)) sum += length(area_normal(t)) / 2.0;
  return sum;
}

/// The volume that the triangles enclose; negative where they face inwards.
inline double volume(const Mesh& mesh) {
  double sum = 0.0;
  for (const MeshTriangle& t : triangles_of(mesh)) sum += dot(t[0], cross(t[1], t[2])) / 6.0;
  return sum;
}

inline double smallest_area(const Mesh& mesh) {
  double smallest = 1e30;
  for (const MeshTriangle& t : triangles_of(mesh)) {
    smallest = std::min(smallest, length(area_normal(t)) / 2.0);
  }
  return smallest;
}

/// How far the length of a normal is from 1, at most.
inline double normal_length_error(const Mesh& mesh) {
  double largest = 0.0;
  for (const glm::vec3& n : mesh.normals) {
    largest = std::max(largest, std::fabs(length(glm::dvec3{n}) - 1.0));
  }
  return largest;
}

/// The smallest cosine between a triangle's own normal and those of its corners.
inline double normal_agreement(const Mesh& mesh) {
  double smallest = 1.0;
  const auto triangles = triangles_of(mesh);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const glm::dvec3 facing = normalize(area_normal(triangles[i]));
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3 normal{mesh.normals[mesh.indices[3 * i + k]]};
      smallest = std::min(smallest, dot(facing, normal));
    }
  }
  return smallest;
}

/// The mesh with vertices of the same bits made one.
struct Welded {
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  std::size_t edges = 0;
  /// Edges of one triangle only, from first to second vertex as it runs.
  std::multimap<std::uint32_t, std::uint32_t> open_edges;
  std::size_t crowded_edges = 0;  ///< of three triangles or more, or of two that run alike
};

inline Welded weld(const Mesh& mesh) {
  std::map<std::tuple<float, float, float>, std::uint32_t> number;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> runs;  // directed edges
  const auto vertex = [&](std::uint32_t index) {
    const glm::vec3 p = mesh.positions[index];
    return number.emplace(std::tuple{p.x, p.y, p.z}, static_cast<std::uint32_t>(number.size()))
        .first->second;
  };
  Welded welded;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const std::array<std::uint32_t, 3> t = {vertex(mesh.indices[i]), vertex(mesh.indices[i + 1]),
                                            vertex(mesh.indices[i + 2])};
    for (std::size_t k = 0; k < 3; ++k) ++runs[{t[k], t[(k + 1) % 3]}];
    ++welded.triangles;
  }
  welded.vertices = number.size();
  for (const auto& [edge, count] : runs) {
    const auto back = runs.find({edge.second, edge.first});
    if (count > 1) ++welded.crowded_edges;
    if (back == runs.end()) {
      welded.open_edges.emplace(edge.first, edge.second);
      ++welded.edges;
    } else if (edge.first < edge.second) {
      ++welded.edges;
    }
  }
  return welded;
}

/// Each edge belongs to exactly two triangles, which run along it in opposite ways.
inline bool is_closed(const Welded& welded) {
  return welded.open_edges.empty() && welded.crowded_edges == 0;
}

/// Vertices - edges + triangles: 2 for what can be blown up to a ball, 0 for a ring.
inline long euler_characteristic(const Welded& welded) {
  return static_cast<long>(welded.vertices) - static_cast<long>(welded.edges) +
         static_cast<long>(welded.triangles);
}

/// How many closed lines the open edges form.
inline std::size_t boundary_loops(const Welded& welded) {
  std::set<std::uint32_t> seen;
  std::size_t loops = 0;
  for (const auto& [from, to] : welded.open_edges) {
    if (seen.contains(from)) continue;
    ++loops;
    for (std::uint32_t at = from; seen.insert(at).second;) {
      const auto next = welded.open_edges.find(at);
      if (next == welded.open_edges.end()) break;
      at = next->second;
    }
  }
  return loops;
}

}  // namespace softfocus::test

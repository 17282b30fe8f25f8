#pragma once
// Facets as a mesh: corners that are equal in the world, and edges between them, are one.

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "scenes/shadows/facets.h"

namespace softfocus {

struct JoinedFacets {
  std::vector<glm::dvec3> corners;
  std::vector<std::array<std::uint32_t, 3>> facets;  ///< the corners of each
  /// The ends of each edge, the lower number first.
  std::vector<std::array<std::uint32_t, 2>> edges;
  /// Of each facet, from corner i to corner i + 1.
  std::vector<std::array<std::uint32_t, 3>> edges_of;
};

/// Corners are equal if their bits are; 0 and -0 are equal, too.
JoinedFacets join_facets(const Facets& facets);

}  // namespace softfocus

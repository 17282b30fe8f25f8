#pragma once
// Facets for tests of shadows.

#include <cstdint>
#include <utility>
#include <vector>

#include "scenes/shadows/facets.h"
#include "tests/support/random.h"

namespace softfocus::test {

/// Two facets; counter-clockwise, seen from the front.
inline void add_quad(std::vector<Facet>& facets, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c,
                     glm::dvec3 d, bool two_sided = true) {
  facets.push_back({{a, b, c}, two_sided});
  facets.push_back({{a, c, d}, two_sided});
}

inline void add_triangle(std::vector<Facet>& facets, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
  facets.push_back({{a, b, c}, true});
}

/// From -reach to reach in x and z, its normal up.
inline void add_floor(std::vector<Facet>& facets, double reach) {
  add_quad(facets, {-reach, 0, reach}, {reach, 0, reach}, {reach, 0, -reach}, {-reach, 0, -reach});
}

/// Triangles at random about the origin, some two-sided, some that cast no shadow.
inline Facets facet_soup(std::uint32_t seed, int triangles, double size) {
  Random random{seed};
  const auto place = [&] {
    const double x = random.between(-1.0, 1.0), y = random.between(-1.0, 1.0);
    return glm::dvec3{x, y, random.between(-1.0, 1.0)};
  };
  std::vector<Facet> facets;
  for (int i = 0; i < triangles; ++i) {
    const glm::dvec3 at = place();
    const glm::dvec3 a = at + place() * size, b = at + place() * size, c = at + place() * size;
    facets.push_back({{a, b, c}, i % 3 == 0, i % 7 != 0});
  }
  return make_facets(std::move(facets));
}

}  // namespace softfocus::test

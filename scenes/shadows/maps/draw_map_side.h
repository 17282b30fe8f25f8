#pragma once
// Casters drawn into a side of a shadow map: cut, covered by the pipeline's rules, the nearest
// kept.

#include <array>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "scenes/shadows/maps/shadow_map.h"

namespace softfocus {

/// A convex polygon in a side's axes: 4 corners, and one more for each cut.
struct MapPolygon {
  std::array<glm::dvec3, 9> corners;
  std::size_t count = 0;
};

/// What of a point light's side is kept: low * z <= (x, y) <= high * z and z >= least_z.
/// A directional light's has 1 in place of z and no least_z.
struct SideCuts {
  glm::dvec2 low, high;
  double least_z = 0.0;
  bool is_directional = false;
};

void cut_to_side(MapPolygon& polygon, const SideCuts& cuts);

/// Sets the side's nearness. It stays empty if no caster is before the side.
void draw_map_side(const Facets& facets, const ShadowLight& light, int size, const Profile& profile,
                   MapSide& side, ThreadPool& pool);

}  // namespace softfocus

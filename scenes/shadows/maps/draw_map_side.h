#pragma once
// Casters drawn into a side of a shadow map: cut, covered by the pipeline's rules, the nearest
// kept.

#include <array>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "raster/pipeline/setup.h"
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

/// A triangle of a caster, in texels. Nearness is over_u * u + (over_v * v + at_origin), from
/// `least` to `most`, which its corners have: the pipeline snaps corners, so a centre can lie
/// beside the caster, and a caster that is nearly edge-on has any nearness there.
struct MapTriangle {
  std::array<WindowVertex, 3> window;
  double over_u, over_v, at_origin;
  double least, most;
};

/// Triangles, and the rows of texels that each may cover: begin <= row < end.
struct CutCasters {
  struct Rows {
    int begin, end;
  };
  std::vector<MapTriangle> triangles;
  std::vector<Rows> rows;
};

/// The casters cut to a side, in parts.
std::vector<CutCasters> cut_casters(const Facets& facets, const ShadowLight& light, int size,
                                    const MapSide& side, ThreadPool& pool);

/// Covers a side's texels with cut casters, and keeps the nearest: sets its nearness, which stays
/// empty if there are none.
void draw_casters(std::span<const CutCasters> casters, int size, const Profile& profile,
                  MapSide& side, ThreadPool& pool);

/// Both.
void draw_map_side(const Facets& facets, const ShadowLight& light, int size, const Profile& profile,
                   MapSide& side, ThreadPool& pool);

}  // namespace softfocus

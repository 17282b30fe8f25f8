#pragma once
// Casters sorted by where they are as seen from a light, so that a receiver finds those before it
// without looking at all. A directional light looks at one square along its direction; a point
// light looks at the six sides of a cube around it.

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "raster/threads/parallel.h"
#include "scenes/shadows/facets.h"

namespace softfocus {

struct LightGrid {
  ShadowLight light;
  int sides = 1;                   ///< 1 or 6
  int cells = 1;                   ///< along each edge of a side
  std::array<glm::dvec3, 2> axes;  ///< of a directional light's side
  glm::dvec2 low{0.0};             ///< its corner
  glm::dvec2 size{1.0};
  /// CSR: the casters in cell i are casters[begins[i]] to casters[begins[i + 1] - 1], in
  /// increasing order.
  std::vector<std::uint32_t> begins;
  std::vector<std::uint32_t> casters;
  std::vector<std::uint32_t> all;  ///< of the casters, in increasing order
  std::size_t facets = 0;          ///< of the scene
};

/// Whether a facet stops light from there: it casts, and the light is on a side that it has.
bool stops_light(const Facet& facet, const FacetPlane& plane, const ShadowLight& light);

/// The same for any number of threads; without a pool, by one. If any receivers are `wanted`,
/// casters are found before their outlines alone.
LightGrid make_light_grid(const Facets& facets, const ShadowLight& light,
                          ThreadPool* pool = nullptr, std::span<const WantedReceiver> wanted = {});

/// Fills `found` with the casters of all cells that a convex polygon may touch, in increasing
/// order, each once.
void find_casters(const LightGrid& grid, std::span<const glm::dvec3> polygon,
                  std::vector<std::uint32_t>& found);

/// Memory that is kept from one search to the next.
struct CasterSearch {
  std::vector<std::uint32_t> found;
  std::vector<std::uint32_t> found_in;  ///< of each facet, the last search that found it
  std::uint32_t search = 0;
};

/// The same, for polygons that touch many cells. One that touches more than half of them gets all
/// casters. Valid until the next search.
std::span<const std::uint32_t> find_casters(const LightGrid& grid,
                                            std::span<const glm::dvec3> polygon,
                                            CasterSearch& search);

}  // namespace softfocus

#pragma once
// What a pixel shows of one light's shadow, by the definition (point_in_shadow.h).

#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "raster/threads/parallel.h"
#include "scenes/shadows/light_grid.h"
#include "scenes/shadows/shadow_mask.h"

namespace softfocus {

class ShadowTruth {
 public:
  /// All outlive it. With `by_grid` the rays ask the casters that a LightGrid finds; without, all.
  ShadowTruth(const Facets& facets, const ShadowLight& light, const ShadowView& view,
              glm::dvec3 eye, bool by_grid);

  /// Of the facet's plane at a place in the window. `memory` is of the thread.
  bool is_dark(SeenFacet seen, glm::dvec2 window, std::vector<std::uint32_t>& memory) const;

  /// Whether the answer is another as at one of 16 points at this distance from there.
  bool is_near_edge(SeenFacet seen, glm::dvec2 window, std::vector<std::uint32_t>& memory,
                    double distance_px = 1.0 / 256.0) const;

  /// Of a point of the facet's plane.
  bool is_dark_at(SeenFacet seen, glm::dvec3 point, std::vector<std::uint32_t>& memory) const;

  glm::dvec3 point(SeenFacet seen, glm::dvec2 window) const;

 private:
  const Facets& facets_;
  const ShadowLight& light_;
  const ShadowView& view_;
  glm::dvec3 eye_;
  LightGrid grid_;
  std::vector<std::uint32_t> all_;
};

/// Whether each pixel is dark, 0 or 1, by rays.
std::vector<std::uint8_t> dark_pixels(const ShadowTruth& truth, std::span<const SeenFacet> seen,
                                      int width, int height, ThreadPool& pool);

}  // namespace softfocus

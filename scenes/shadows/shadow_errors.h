#pragma once
// How right a shadow mask is: every pixel against the definition (point_in_shadow.h).

#include <cstddef>
#include <cstdint>
#include <span>

#include "raster/threads/parallel.h"
#include "scenes/shadows/shadow_mask.h"

namespace softfocus {

/// Pixels times lights.
struct ShadowErrors {
  std::size_t seen = 0;       ///< that show a facet
  std::size_t in_shadow = 0;  ///< of these
  std::size_t near_edge = 0;  ///< answered otherwise than at the centre, but as 1/256 pixel from it
  std::size_t wrong = 0;      ///< answered otherwise than anywhere within 1/256 pixel
};

/// `lights` are those of the mask's bits. With `by_grid` the rays ask the casters that a LightGrid
/// finds; without, all.
ShadowErrors shadow_errors(const Facets& facets, std::span<const ShadowLight> lights,
                           std::span<const SeenFacet> seen, std::span<const std::uint8_t> mask,
                           const ShadowView& view, glm::dvec3 eye, bool by_grid, ThreadPool& pool);

}  // namespace softfocus

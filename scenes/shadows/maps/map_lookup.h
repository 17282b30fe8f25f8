#pragma once
// Shadow maps seen by a camera: the lights' bits of a shadow mask, and their shares where the
// kernel is wider than a texel.

#include <cstdint>
#include <span>
#include <vector>

#include "raster/threads/parallel.h"
#include "scenes/shadows/maps/shadow_map.h"
#include "scenes/shadows/shadow_mask.h"

namespace softfocus {

/// A light's map, its bit in the mask, and where the shares go that are neither none nor all.
struct MapLookup {
  const ShadowMap* map;
  int bit;
  /// blocked_texels() of each pixel, or 0 if it is all of the kernel: then the bit is set, as it is
  /// for kernels of one texel. Empty for these.
  std::span<std::uint8_t> shares;
};

/// Looks up the point that each pixel shows. Pixels whose bit is set already are dark sides, and
/// keep it. `seen`, `mask` and `shares` are rows from the top, without gaps.
void look_up_maps(const Facets& facets, std::span<const MapLookup> lookups,
                  std::span<const SeenFacet> seen, const ShadowView& view, glm::dvec3 eye,
                  std::span<std::uint8_t> mask, ThreadPool& pool);

}  // namespace softfocus

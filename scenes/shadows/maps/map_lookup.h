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

/// What a pixel is compared with, for who compares by other means.
struct PixelComparison {
  std::uint32_t side = 0;  ///< 1 + its number in the map; 0: nothing is nearer
  MapComparison with{0, 0, 0.0};
};

/// Of each pixel. Pixels whose bit is set in the mask are dark sides, and are compared with
/// nothing.
std::vector<PixelComparison> pixel_comparisons(const Facets& facets, const ShadowMap& map, int bit,
                                               std::span<const SeenFacet> seen,
                                               const ShadowView& view, glm::dvec3 eye,
                                               std::span<const std::uint8_t> mask,
                                               ThreadPool& pool);

}  // namespace softfocus

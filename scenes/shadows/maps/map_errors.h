#pragma once
// How wrong a shadow map is, and why: every pixel against the definition (shadow_truth.h).

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "raster/threads/parallel.h"
#include "scenes/shadows/maps/shadow_map.h"
#include "scenes/shadows/shadow_truth.h"

namespace softfocus {

/// Pixels. One is dark by a map if more than half of the kernel is; it is wrong if the definition
/// says otherwise. A wrong pixel is one of
///
///   near_edge      answered otherwise within 1/256 pixel
///   aliasing       answered otherwise within the kernel's reach: at a point of the plane that the
///                  map sees half a kernel's width from there in u or v, or in both, or at the
///                  centre of a texel that is compared. The map is too coarse.
///   acne           none of these, lit by truth. The receiver shades itself: too little bias.
///   peter_panning  none of these, dark by truth. The caster came loose: too much bias.
struct MapErrors {
  std::size_t seen = 0;       ///< that show a facet
  std::size_t in_shadow = 0;  ///< of these, by truth
  std::size_t near_edge = 0;
  std::size_t aliasing = 0;
  std::size_t acne = 0;
  std::size_t peter_panning = 0;
  /// Sum over the pixels that are seen: how far the share that the map takes is from 0 or 1.
  double missed_share = 0.0;

  std::size_t wrong() const { return aliasing + acne + peter_panning; }
};

MapErrors& operator+=(MapErrors& sum, const MapErrors& more);

/// `is_dark` is the truth's. Bit `bit` of the mask is the map's, likewise its shares
/// (map_lookup.h).
MapErrors map_errors(const Facets& facets, const ShadowMap& map, const ShadowTruth& truth,
                     std::span<const std::uint8_t> is_dark, std::span<const SeenFacet> seen,
                     std::span<const std::uint8_t> mask, int bit,
                     std::span<const std::uint8_t> shares, int width, int height, ThreadPool& pool);

}  // namespace softfocus

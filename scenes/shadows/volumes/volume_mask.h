#pragma once
// Shadow volumes seen by a camera: the count of a stencil for each pixel.
//
// A pixel's sample is not the point that it shows but the one that is epsilon_m over the
// receiver's plane, towards the light. It is in a volume exactly if a caster stops the light there
// at a height of more than epsilon_m, which is the definition (shadow_truth.h). A surface's own
// cap, and all that touches it, lies clear of its sample.
//
// The ray from the eye through the sample meets the faces of the volumes. Coverage and the faces'
// depths are computed in binary64, at the sample, without a division, a clipped corner or a corner
// rounded to the grid: for corners v_i = (x, y, w) in clip coordinates about the eye, W_i = 1 or,
// at infinity, 0, a sample (x, y, 1) at depth 1 / q, and v_j x v_k . (x, y, 1) = E_i (Olano and
// Greer 1997), a face is met if all E_i have one sign, and behind the sample if that is also the
// sign of q sum(E_i w_i) - sum(E_i W_i). Faces that run behind the camera need no other care. Faces
// with a common edge get the same E to the bit: no gaps, and nothing counts twice.

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "raster/threads/parallel.h"
#include "scenes/shadows/projected_shadows.h"
#include "scenes/shadows/shadow_mask.h"
#include "scenes/shadows/volumes/shadow_volumes.h"

namespace softfocus {

/// Sets `bit` of the mask where volumes hold what a pixel shows. Pixels that have the bit are left
/// alone; draw_shadow_mask() gives it to sides that the light is not on. `lit` is lit_sides().
/// Returns the number of pixels whose sample lies more than half a pixel beside them: where the
/// light grazes a surface, or the surface the ray. Their volumes are counted along the ray to the
/// light.
std::size_t draw_volume_mask(const Facets& facets, const JoinedFacets& joined,
                             ShadowVolumes& volumes, std::span<const LitSide> lit, std::uint8_t bit,
                             std::span<const SeenFacet> seen, const ShadowView& view,
                             glm::dvec3 eye, VolumeCount count, std::span<std::uint8_t> mask,
                             ThreadPool& pool);

/// What pixels' samples come to, for who counts by other means.
struct VolumeCounts {
  std::vector<glm::dvec3> corners;  ///< in pixels (shadow_volumes.h), as the faces number them
  std::size_t faces = 0;            ///< so many of the light's are counted
  /// Of each pixel: x, y and q = 1 / w. Zero if it has none, or if that lies elsewhere.
  std::vector<glm::dvec3> samples;
  std::vector<std::int64_t> counts;  ///< of each pixel with a sample; without the eye's volumes
};

/// As draw_volume_mask() counts them for that mask.
VolumeCounts count_volumes(const Facets& facets, const JoinedFacets& joined,
                           const ShadowVolumes& volumes, std::span<const LitSide> lit,
                           std::uint8_t bit, std::span<const SeenFacet> seen,
                           const ShadowView& view, glm::dvec3 eye, VolumeCount count,
                           std::span<std::uint8_t> mask, ThreadPool& pool);

}  // namespace softfocus

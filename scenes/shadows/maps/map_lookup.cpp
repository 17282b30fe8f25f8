#include "scenes/shadows/maps/map_lookup.h"

#include <algorithm>
#include <optional>

#include "scenes/shadows/shadow_truth.h"

namespace softfocus {
namespace {

// Runs body(pixel, its facet's receiver, point) for pixels that show a facet with a plane and do
// not have all of `bits` in the mask.
template <class Body>
void for_each_lit_point(const Facets& facets, unsigned bits, std::span<const SeenFacet> seen,
                        const ShadowView& view, glm::dvec3 eye, std::span<const std::uint8_t> mask,
                        ThreadPool& pool, const Body& body) {
  for_each_seen(seen, view.width, view.height, pool, [&](const SeenPixel& at, auto&) {
    const std::uint32_t facet = facet_of(at.seen);
    const FacetPlane& plane = facets.planes[facet];
    if ((mask[at.index] & bits) == bits || !has_plane(plane)) return;
    body(at.index, facets.receivers[facets.receiver_of[facet]],
         seen_point(plane, view.world_to_clip, eye, at.centre, view.width, view.height));
  });
}

}  // namespace

void look_up_maps(const Facets& facets, std::span<const MapLookup> lookups,
                  std::span<const SeenFacet> seen, const ShadowView& view, glm::dvec3 eye,
                  std::span<std::uint8_t> mask, ThreadPool& pool) {
  unsigned all_bits = 0;
  for (const MapLookup& lookup : lookups) {
    all_bits |= 1u << lookup.bit;
    std::ranges::fill(lookup.shares, std::uint8_t{0});
  }
  const auto look_up = [&](std::size_t pixel, const Receiver& receiver, glm::dvec3 point) {
    for (const MapLookup& lookup : lookups) {
      const ShadowMap& map = *lookup.map;
      if ((mask[pixel] >> lookup.bit & 1) != 0) continue;
      const int blocked = blocked_texels(map, map_place(map, receiver, point));
      if (blocked == map.settings.kernel * map.settings.kernel) {
        mask[pixel] = static_cast<std::uint8_t>(mask[pixel] | 1u << lookup.bit);
      } else if (!lookup.shares.empty()) {
        lookup.shares[pixel] = static_cast<std::uint8_t>(blocked);
      }
    }
  };
  for_each_lit_point(facets, all_bits, seen, view, eye, mask, pool, look_up);
}

std::vector<PixelComparison> pixel_comparisons(const Facets& facets, const ShadowMap& map, int bit,
                                               std::span<const SeenFacet> seen,
                                               const ShadowView& view, glm::dvec3 eye,
                                               std::span<const std::uint8_t> mask,
                                               ThreadPool& pool) {
  std::vector<PixelComparison> of_pixels(seen.size());
  const auto compare = [&](std::size_t pixel, const Receiver& receiver, glm::dvec3 point) {
    const MapPlace place = map_place(map, receiver, point);
    const std::optional<MapComparison> with = map_comparison(map, place);
    if (!with) return;
    const auto number = static_cast<std::uint32_t>(place.side - map.sides.data());
    of_pixels[pixel] = {number + 1, *with};
  };
  for_each_lit_point(facets, 1u << bit, seen, view, eye, mask, pool, compare);
  return of_pixels;
}

}  // namespace softfocus

#include "scenes/shadows/maps/map_lookup.h"

#include "scenes/shadows/point_in_shadow.h"

namespace softfocus {

void look_up_maps(const Facets& facets, std::span<const MapLookup> lookups,
                  std::span<const SeenFacet> seen, const ShadowView& view, glm::dvec3 eye,
                  std::span<std::uint8_t> mask, ThreadPool& pool) {
  unsigned all_bits = 0;
  for (const MapLookup& lookup : lookups) all_bits |= 1u << lookup.bit;
  pool.for_each(view.height, [&](int y) {
    for (int x = 0; x < view.width; ++x) {
      const std::size_t pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) +
                                static_cast<std::size_t>(x);
      for (const MapLookup& lookup : lookups) {
        if (!lookup.shares.empty()) lookup.shares[pixel] = 0;
      }
      if (!shows_facet(seen[pixel]) || (mask[pixel] & all_bits) == all_bits) continue;
      const std::uint32_t facet = facet_of(seen[pixel]);
      const FacetPlane& plane = facets.planes[facet];
      if (!has_plane(plane)) continue;
      const glm::dvec3 point =
          seen_point(plane, view.world_to_clip, eye, {x + 0.5, y + 0.5}, view.width, view.height);
      const Receiver& receiver = facets.receivers[facets.receiver_of[facet]];
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
    }
  });
}

}  // namespace softfocus

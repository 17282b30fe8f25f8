#include "scenes/shadows/maps/map_lookup.h"

#include <optional>

#include "scenes/shadows/shadow_truth.h"

namespace softfocus {
namespace {

struct SeenPoint {
  const Receiver* receiver;
  glm::dvec3 point;
};

std::optional<SeenPoint> point_of_pixel(const Facets& facets, SeenFacet seen,
                                        const ShadowView& view, glm::dvec3 eye, int x, int y) {
  if (!shows_facet(seen)) return std::nullopt;
  const std::uint32_t facet = facet_of(seen);
  const FacetPlane& plane = facets.planes[facet];
  if (!has_plane(plane)) return std::nullopt;
  return SeenPoint{
      &facets.receivers[facets.receiver_of[facet]],
      seen_point(plane, view.world_to_clip, eye, {x + 0.5, y + 0.5}, view.width, view.height)};
}

}  // namespace

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
      if ((mask[pixel] & all_bits) == all_bits) continue;
      const auto shown = point_of_pixel(facets, seen[pixel], view, eye, x, y);
      if (!shown) continue;
      for (const MapLookup& lookup : lookups) {
        const ShadowMap& map = *lookup.map;
        if ((mask[pixel] >> lookup.bit & 1) != 0) continue;
        const int blocked = blocked_texels(map, map_place(map, *shown->receiver, shown->point));
        if (blocked == map.settings.kernel * map.settings.kernel) {
          mask[pixel] = static_cast<std::uint8_t>(mask[pixel] | 1u << lookup.bit);
        } else if (!lookup.shares.empty()) {
          lookup.shares[pixel] = static_cast<std::uint8_t>(blocked);
        }
      }
    }
  });
}

std::vector<PixelComparison> pixel_comparisons(const Facets& facets, const ShadowMap& map, int bit,
                                               std::span<const SeenFacet> seen,
                                               const ShadowView& view, glm::dvec3 eye,
                                               std::span<const std::uint8_t> mask,
                                               ThreadPool& pool) {
  std::vector<PixelComparison> of_pixels(seen.size());
  pool.for_each(view.height, [&](int y) {
    for (int x = 0; x < view.width; ++x) {
      const std::size_t pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) +
                                static_cast<std::size_t>(x);
      if ((mask[pixel] >> bit & 1) != 0) continue;
      const auto shown = point_of_pixel(facets, seen[pixel], view, eye, x, y);
      if (!shown) continue;
      const MapPlace place = map_place(map, *shown->receiver, shown->point);
      const std::optional<MapComparison> with = map_comparison(map, place);
      if (!with) continue;
      const auto number = static_cast<std::uint32_t>(place.side - map.sides.data());
      of_pixels[pixel] = {number + 1, *with};
    }
  });
  return of_pixels;
}

}  // namespace softfocus

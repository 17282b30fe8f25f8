#include "scenes/shadows/maps/map_errors.h"

#include <cmath>

namespace softfocus {
namespace {

// The point of the plane that is seen at (u, v).
glm::dvec3 point_at(const ShadowMap& map, const MapSide& side, const FacetPlane& plane, double u,
                    double v) {
  const double x = u / side.texels.x + side.low.x, y = v / side.texels.y + side.low.y;
  const glm::dvec3 across = side.axes[0] * x + side.axes[1] * y;
  const bool is_point = map.light.w != 0.0;
  const glm::dvec3 from = is_point ? side.origin : side.origin + across;
  const glm::dvec3 ray = is_point ? across + side.axes[2] : side.axes[2];
  return from + ray * (-height_over(plane, from) / dot(plane.normal, ray));
}

// Whether a ray answers otherwise somewhere in the kernel's reach: around it, or at a centre that
// it compares.
bool is_at_edge(const Facets& facets, const ShadowMap& map, const ShadowTruth& truth,
                SeenFacet seen, glm::dvec3 point, bool is_dark,
                std::vector<std::uint32_t>& memory) {
  const FacetPlane& plane = facets.planes[facet_of(seen)];
  if (!has_plane(plane)) return false;
  const MapPlace place =
      map_place(map, facets.receivers[facets.receiver_of[facet_of(seen)]], point);
  if (place.side->nearness.empty()) return false;
  const auto differs = [&](double u, double v) {
    return truth.is_dark_at(seen, point_at(map, *place.side, plane, u, v), memory) != is_dark;
  };
  const int kernel = map.settings.kernel, before = kernel / 2;
  const double u = std::floor(place.u) - before, v = std::floor(place.v) - before;
  for (int j = 0; j < kernel; ++j) {
    for (int i = 0; i < kernel; ++i) {
      if (differs(u + i + 0.5, v + j + 0.5)) return true;
    }
  }
  const double half = kernel / 2.0;
  for (const double across : {-half, 0.0, half}) {
    for (const double down : {-half, 0.0, half}) {
      if (differs(place.u + across, place.v + down)) return true;
    }
  }
  return false;
}

}  // namespace

MapErrors& operator+=(MapErrors& sum, const MapErrors& more) {
  sum.seen += more.seen;
  sum.in_shadow += more.in_shadow;
  sum.near_edge += more.near_edge;
  sum.aliasing += more.aliasing;
  sum.acne += more.acne;
  sum.peter_panning += more.peter_panning;
  sum.missed_share += more.missed_share;
  return sum;
}

MapErrors map_errors(const Facets& facets, const ShadowMap& map, const ShadowTruth& truth,
                     std::span<const std::uint8_t> is_dark, std::span<const SeenFacet> seen,
                     std::span<const std::uint8_t> mask, int bit,
                     std::span<const std::uint8_t> shares, int width, int height,
                     ThreadPool& pool) {
  const double whole = map.settings.kernel * map.settings.kernel;
  const auto judge = [&](const SeenPixel& at, auto& memory, MapErrors& errors) {
    const bool dark = is_dark[at.index] != 0;
    double share = (mask[at.index] >> bit & 1) != 0 ? 1.0 : 0.0;
    if (share == 0.0 && !shares.empty()) share = shares[at.index] / whole;
    ++errors.seen;
    errors.in_shadow += dark ? 1 : 0;
    errors.missed_share += std::fabs(share - (dark ? 1.0 : 0.0));
    if ((share > 0.5) == dark) return;
    if (truth.is_near_edge(at.seen, at.centre, memory)) {
      ++errors.near_edge;
    } else if (is_at_edge(facets, map, truth, at.seen, truth.point(at.seen, at.centre), dark,
                          memory)) {
      ++errors.aliasing;
    } else {
      ++(dark ? errors.peter_panning : errors.acne);
    }
  };
  return sum_over_seen<MapErrors>(seen, width, height, pool, judge);
}

}  // namespace softfocus

#include "scenes/shadows/volumes/shadow_volumes.h"

#include <algorithm>
#include <utility>

namespace softfocus {
namespace {

// A triangle with a corner at the light is seen edge-on, and its corner has no direction.
bool throws_volume(const Facets& facets, std::uint32_t facet, const ShadowLight& light) {
  const auto& corners = facets.facets[facet].corners;
  return stops_light(facets.facets[facet], facets.planes[facet], light) &&
         (light.w == 0.0 ||
          std::find(corners.begin(), corners.end(), light.place) == corners.end());
}

bool is_turned(const Facets& facets, std::uint32_t facet, const ShadowLight& light) {
  return height_over(facets.planes[facet], light) < 0.0;
}

}  // namespace

ShadowVolumes make_shadow_volumes(const Facets& facets, const JoinedFacets& joined,
                                  const ShadowLight& light) {
  ShadowVolumes made;
  made.light = light;
  std::vector<std::int32_t> sums(joined.edges.size(), 0);
  for (std::uint32_t i = 0; i < facets.facets.size(); ++i) {
    if (!throws_volume(facets, i, light)) continue;
    made.casters.push_back(i);
    std::array<std::uint32_t, 3> corners = joined.facets[i];
    const bool turned = is_turned(facets, i, light);
    for (std::size_t k = 0; k < 3; ++k) {
      const bool upwards = corners[k] < corners[(k + 1) % 3];
      sums[joined.edges_of[i][k]] += upwards != turned ? 1 : -1;
    }
    if (turned) std::swap(corners[1], corners[2]);
    made.faces.push_back({corners, 1});
  }
  const auto far = static_cast<std::uint32_t>(joined.corners.size());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (sums[i] == 0) continue;
    ++made.silhouette_edges;
    const auto [a, b] = joined.edges[i];
    if (light.w == 0.0) {
      made.faces.push_back({{b, a, far}, sums[i]});
    } else {
      made.faces.push_back({{b, a, far + a}, sums[i]});
      made.faces.push_back({{b, far + a, far + b}, sums[i]});
    }
  }
  made.faces_before_far_caps = made.faces.size();
  if (light.w != 0.0) {
    for (std::size_t i = 0; i < made.casters.size(); ++i) {
      const auto [a, b, c] = made.faces[i].corners;
      made.faces.push_back({{far + a, far + c, far + b}, 1});
    }
  }
  return made;
}

int volumes_that_hold(const Facets& facets, const JoinedFacets& joined, const ShadowLight& light,
                      std::span<const std::uint32_t> casters, glm::dvec3 point) {
  const glm::dvec3 towards = light.place - point * light.w;
  int count = 0;
  for (const std::uint32_t caster : casters) {
    if (!throws_volume(facets, caster, light)) continue;
    const double turn = is_turned(facets, caster, light) ? -1.0 : 1.0;
    if (turn * height_over(facets.planes[caster], point) >= 0.0) continue;
    bool meets = true;
    for (std::size_t i = 0; i < 3 && meets; ++i) {
      // From the lower corner to the higher: the two triangles of an edge get the same bits.
      const std::uint32_t from = joined.facets[caster][i], to = joined.facets[caster][(i + 1) % 3];
      const double upwards = dot(towards, cross(joined.corners[std::min(from, to)] - point,
                                                joined.corners[std::max(from, to)] - point));
      const bool is_left = upwards >= 0.0;
      meets = is_left == ((from < to) == (turn > 0.0));
    }
    count += meets ? 1 : 0;
  }
  return count;
}

}  // namespace softfocus

#include "scenes/shadows/volumes/shadow_volumes.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <utility>

namespace softfocus {
namespace {

constexpr std::uint32_t kNoNumber = ~std::uint32_t{0};

// Numbers things in the order in which they first come. Linear probing; at most half full.
template <class Thing>
class Numbers {
 public:
  explicit Numbers(std::size_t most) : slots_(std::bit_ceil(2 * most + 1), kNoNumber) {}

  std::uint32_t number_of(const Thing& thing, std::uint64_t hash, std::vector<Thing>& things) {
    std::size_t slot = (hash ^ hash >> 32) & (slots_.size() - 1);
    while (slots_[slot] != kNoNumber && things[slots_[slot]] != thing) {
      slot = (slot + 1) & (slots_.size() - 1);
    }
    if (slots_[slot] == kNoNumber) {
      slots_[slot] = static_cast<std::uint32_t>(things.size());
      things.push_back(thing);
    }
    return slots_[slot];
  }

 private:
  std::vector<std::uint32_t> slots_;
};

std::uint64_t mix(std::uint64_t hash, std::uint64_t bits) {
  hash = (hash ^ bits) * 0x9E3779B97F4A7C15u;
  return hash ^ hash >> 32;
}

std::uint64_t corner_hash(const glm::dvec3& p) {
  std::uint64_t hash = 0;
  for (int i = 0; i < 3; ++i) hash = mix(hash, std::bit_cast<std::uint64_t>(p[i] + 0.0));
  return hash;
}

}  // namespace

JoinedFacets join_facets(const Facets& facets) {
  JoinedFacets joined;
  const std::size_t count = facets.facets.size();
  joined.facets.reserve(count);
  joined.edges_of.reserve(count);
  Numbers<glm::dvec3> corners{3 * count};
  Numbers<std::array<std::uint32_t, 2>> edges{3 * count};
  for (const Facet& facet : facets.facets) {
    std::array<std::uint32_t, 3> of{}, edges_of{};
    for (std::size_t i = 0; i < 3; ++i) {
      of[i] = corners.number_of(facet.corners[i], corner_hash(facet.corners[i]), joined.corners);
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = of[i], to = of[(i + 1) % 3];
      const std::array<std::uint32_t, 2> ends{std::min(from, to), std::max(from, to)};
      edges_of[i] = edges.number_of(ends, mix(mix(0, ends[0]), ends[1]), joined.edges);
    }
    joined.facets.push_back(of);
    joined.edges_of.push_back(edges_of);
  }
  return joined;
}

PixelSpace pixel_space(const ShadowView& view, glm::dvec3 eye) {
  const auto row = [&](int i) {
    const glm::dmat4& m = view.world_to_clip;
    return glm::dvec3{m[0][i], m[1][i], m[2][i]};
  };
  PixelSpace space{};
  space.eye = eye;
  space.rows = {(row(0) + row(3)) * (view.width / 2.0), (row(1) + row(3)) * (view.height / 2.0),
                row(3)};
  const auto& [x, y, w] = space.rows;
  const double determinant = dot(x, cross(y, w));
  space.columns = {cross(y, w) / determinant, cross(w, x) / determinant, cross(x, y) / determinant};
  space.facing = determinant > 0.0 ? -1.0 : 1.0;
  // z = a w + b, and -w = z is the near plane. A quarter of its depth: samples may come nearer.
  const double a = dot(row(2), w) / dot(w, w);
  const double b = dot(row(2), eye) + view.world_to_clip[3][2];
  space.least_w = -0.25 * b / (1.0 + a);
  return space;
}

glm::dvec3 to_pixels(const PixelSpace& space, glm::dvec3 from_eye) {
  return {dot(space.rows[0], from_eye), dot(space.rows[1], from_eye), dot(space.rows[2], from_eye)};
}

glm::dvec3 from_pixels(const PixelSpace& space, glm::dvec3 v) {
  return (space.columns[0] * v.x + space.columns[1] * v.y) + space.columns[2] * v.z;
}

glm::dvec3 to_light(const PixelSpace& space, const ShadowLight& light) {
  return to_pixels(space, light.place - space.eye * light.w);
}

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

#include "scenes/shadows/volumes/joined_facets.h"

#include <algorithm>
#include <bit>
#include <cstddef>

namespace softfocus {
namespace {

constexpr std::uint32_t kNone = ~std::uint32_t{0};

// Numbers things in the order in which they first come. Linear probing; at most half full.
template <class Thing>
class Numbers {
 public:
  explicit Numbers(std::size_t most) : slots_(std::bit_ceil(2 * most + 1), kNone) {}

  std::uint32_t number_of(const Thing& thing, std::uint64_t hash, std::vector<Thing>& things) {
    std::size_t slot = (hash ^ hash >> 32) & (slots_.size() - 1);
    while (slots_[slot] != kNone && things[slots_[slot]] != thing) {
      slot = (slot + 1) & (slots_.size() - 1);
    }
    if (slots_[slot] == kNone) {
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

}  // namespace softfocus

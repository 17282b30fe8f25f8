#include "scenes/shadows/facets.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/vec2.hpp>
#include <limits>
#include <utility>

namespace softfocus {
namespace {

constexpr std::uint32_t kNoReceiver = ~std::uint32_t{0};

// A triangle whose height is 1e-12 of its longest side is a line.
constexpr double kLeastArea = 1e-12;

FacetPlane plane_of(const Facet& facet) {
  const auto& [a, b, c] = facet.corners;
  const glm::dvec3 across = cross(b - a, c - a);
  const double longest = std::max({dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c)});
  if (!(dot(across, across) > kLeastArea * kLeastArea * longest * longest)) return {};
  const glm::dvec3 normal = normalize(across);
  return {normal, dot(normal, a)};
}

double diagonal_m(std::span<const Facet> facets) {
  glm::dvec3 low{std::numeric_limits<double>::infinity()};
  glm::dvec3 high{-std::numeric_limits<double>::infinity()};
  for (const Facet& facet : facets) {
    for (const glm::dvec3& corner : facet.corners) {
      for (int i = 0; i < 3; ++i) {
        low[i] = std::min(low[i], corner[i]);
        high[i] = std::max(high[i], corner[i]);
      }
    }
  }
  return facets.empty() ? 0.0 : std::sqrt(dot(high - low, high - low));
}

std::uint64_t hash_of(glm::dvec3 p) {
  std::uint64_t hash = 0xCBF29CE484222325u;
  for (int i = 0; i < 3; ++i) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(p[i] + 0.0)) * 0x9E3779B97F4A7C15u;
    hash ^= hash >> 32;
  }
  return hash;
}

// An edge by its ends, in either direction. Should two edges ever share a number, coplanar facets
// that do not touch share a receiver, which is harmless.
struct NumberedEdge {
  std::uint64_t number;
  std::uint32_t facet;
  bool operator<(const NumberedEdge& other) const {
    return number != other.number ? number < other.number : facet < other.facet;
  }
};

// The neighbours of a facet at an edge are a range of a sorted list of edges.
struct Neighbours {
  std::vector<NumberedEdge> edges;
  std::vector<std::uint32_t> place;  // of each facet's edges: where their range begins
};

Neighbours neighbours_of(std::span<const Facet> facets) {
  Neighbours found;
  found.edges.reserve(3 * facets.size());
  std::vector<std::uint64_t> numbers;
  numbers.reserve(3 * facets.size());
  for (std::size_t f = 0; f < facets.size(); ++f) {
    std::array<std::uint64_t, 3> hashes{};
    for (std::size_t i = 0; i < 3; ++i) hashes[i] = hash_of(facets[f].corners[i]);
    for (std::size_t i = 0; i < 3; ++i) {
      numbers.push_back(hashes[i] + hashes[(i + 1) % 3]);
      found.edges.push_back({numbers.back(), static_cast<std::uint32_t>(f)});
    }
  }
  std::sort(found.edges.begin(), found.edges.end());
  found.place.resize(numbers.size());
  std::size_t begin = 0;
  for (std::size_t i = 0; i < found.edges.size(); ++i) {
    if (found.edges[i].number != found.edges[begin].number) begin = i;
    const std::size_t first = 3 * std::size_t{found.edges[i].facet};
    for (std::size_t k = first; k < first + 3; ++k) {
      if (numbers[k] == found.edges[i].number) found.place[k] = static_cast<std::uint32_t>(begin);
    }
  }
  return found;
}

bool lies_in(const Facets& of, std::uint32_t facet, const FacetPlane& plane) {
  if (!has_plane(of.planes[facet]) || dot(of.planes[facet].normal, plane.normal) <= 0.0) {
    return false;
  }
  const auto& corners = of.facets[facet].corners;
  return std::all_of(corners.begin(), corners.end(), [&](const glm::dvec3& corner) {
    return std::fabs(height_over(plane, corner)) <= 0.5 * of.epsilon_m;
  });
}

// A rectangle that holds all of them, along a side of the first: of three the smallest.
void set_rectangle(const Facets& of, std::span<const std::uint32_t> members, Receiver& receiver) {
  const auto& seed = of.facets[members[0]].corners;
  double least_area = std::numeric_limits<double>::infinity();
  for (std::size_t side = 0; side < 3; ++side) {
    const glm::dvec3 right = normalize(seed[(side + 1) % 3] - seed[side]);
    const glm::dvec3 up = cross(receiver.plane.normal, right);
    glm::dvec2 low{0.0}, high{0.0};
    for (const std::uint32_t member : members) {
      for (const glm::dvec3& corner : of.facets[member].corners) {
        const glm::dvec2 p{dot(corner - seed[0], right), dot(corner - seed[0], up)};
        low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
      }
    }
    const double area = (high.x - low.x) * (high.y - low.y);
    if (area >= least_area) continue;
    least_area = area;
    receiver.outline = {
        seed[0] + (right * low.x + up * low.y), seed[0] + (right * high.x + up * low.y),
        seed[0] + (right * high.x + up * high.y), seed[0] + (right * low.x + up * high.y)};
  }
  receiver.corners = 4;
}

}  // namespace

Facets make_facets(std::vector<Facet> facets) {
  Facets made;
  made.facets = std::move(facets);
  made.epsilon_m = std::ldexp(diagonal_m(made.facets), -21);
  made.planes.reserve(made.facets.size());
  for (const Facet& facet : made.facets) made.planes.push_back(plane_of(facet));
  made.receiver_of.assign(made.facets.size(), kNoReceiver);
  const Neighbours neighbours = neighbours_of(made.facets);

  std::vector<std::uint32_t> members;
  for (std::uint32_t first = 0; first < made.facets.size(); ++first) {
    if (made.receiver_of[first] != kNoReceiver) continue;
    const auto number = static_cast<std::uint32_t>(made.receivers.size());
    const FacetPlane& plane = made.planes[first];
    members.assign(1, first);
    made.receiver_of[first] = number;
    for (std::size_t i = 0; has_plane(plane) && i < members.size(); ++i) {
      for (std::size_t edge = 0; edge < 3; ++edge) {
        std::size_t at = neighbours.place[3 * std::size_t{members[i]} + edge];
        const std::uint64_t of_edge = neighbours.edges[at].number;
        for (; at < neighbours.edges.size() && neighbours.edges[at].number == of_edge; ++at) {
          const std::uint32_t next = neighbours.edges[at].facet;
          if (made.receiver_of[next] != kNoReceiver ||
              made.facets[next].two_sided != made.facets[first].two_sided ||
              !lies_in(made, next, plane)) {
            continue;
          }
          made.receiver_of[next] = number;
          members.push_back(next);
        }
      }
    }
    const auto& [a, b, c] = made.facets[first].corners;
    Receiver receiver{plane, made.facets[first].two_sided, {a, b, c, c}, 3};
    if (members.size() > 1) set_rectangle(made, members, receiver);
    made.receivers.push_back(receiver);
  }
  return made;
}

}  // namespace softfocus

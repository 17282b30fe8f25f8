#pragma once
// The surfaces of a scene as shadows need them: facets in the world, in binary64, and receivers,
// which are coplanar facets joined at their edges.

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <span>
#include <vector>

#include "raster/numbers/vector_math.h"

namespace softfocus {

// A box around places as a light sees them.

/// Empty at first.
struct PlaceBox {
  glm::dvec2 low{std::numeric_limits<double>::infinity()};
  glm::dvec2 high{-std::numeric_limits<double>::infinity()};
};

inline void add(PlaceBox& box, glm::dvec2 p) {
  box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y)};
  box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y)};
}

/// A triangle. A one-sided facet can be seen from its front alone, and stops light on its front
/// alone.
struct Facet {
  std::array<glm::dvec3, 3> corners;  ///< counter-clockwise, seen from the front
  bool two_sided = false;
  bool casts = true;
};

/// normal . p = offset. The normal has length 1, or is zero: a facet without area has no plane.
struct FacetPlane {
  glm::dvec3 normal{0.0};
  double offset = 0.0;
};

inline bool has_plane(const FacetPlane& plane) { return plane.normal != glm::dvec3{0.0}; }

inline double height_over(const FacetPlane& plane, glm::dvec3 p) {
  return dot(plane.normal, p) - plane.offset;
}

/// A point light is at `place`, with w = 1. A directional one is towards `place`, of length 1, with
/// w = 0.
struct ShadowLight {
  glm::dvec3 place{0.0, 1.0, 0.0};
  double w = 0.0;
  bool operator==(const ShadowLight&) const = default;
};

/// Of a directional light, the cosine of its angle with the normal.
inline double height_over(const FacetPlane& plane, const ShadowLight& light) {
  return dot(plane.normal, light.place) - light.w * plane.offset;
}

/// Facets that share a plane and hang together. What they receive is drawn once.
struct Receiver {
  FacetPlane plane;
  bool two_sided = false;
  /// A convex polygon that holds them: a triangle, or a rectangle.
  std::array<glm::dvec3, 4> outline;
  std::size_t corners = 3;

  std::span<const glm::dvec3> corners_of_outline() const { return {outline.data(), corners}; }
};

/// A receiver, and a convex part of its outline that shadows are wanted on.
struct WantedReceiver {
  std::uint32_t receiver;
  std::array<glm::dvec3, 8> outline;
  std::size_t corners;

  std::span<const glm::dvec3> corners_of_outline() const { return {outline.data(), corners}; }
};

struct Facets {
  std::vector<Facet> facets;
  std::vector<FacetPlane> planes;          ///< of each facet
  std::vector<std::uint32_t> receiver_of;  ///< of each facet
  std::vector<Receiver> receivers;
  /// In metres. What is no higher over a receiver casts no shadow on it: 2^-21 of the diagonal of
  /// the box that holds the facets. Positions are given in binary32, so the corners of what is
  /// meant to be one plane lie off it by up to 2^-24 of their size.
  double epsilon_m = 0.0;
};

Facets make_facets(std::vector<Facet> facets);

}  // namespace softfocus

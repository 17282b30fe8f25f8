#pragma once
// Where light ends on a curved surface that is made of few facets. Shadows end it at facets, in a
// polygon: a facet that turns away from the light is dark, although its corners' normals, with
// which it is lit, may still face the light. Two rules in place of that, each for a light at a
// time:
//
//   normals  Light ends where the normals turn away. With c_i the cosines between the corners'
//            normals and the light, and c and c+ what lies between the c_i and between the
//            max(c_i, 0) at a point: the light's share there is of c+, as lighting is at vertices,
//            and max(c, 0) / c+ of it is kept. Beyond the line c = 0 nothing is; where all corners
//            face the light, all. So a facet that turns away may be lit: a point of it with c > 0
//            is in shadow only if its ray to the light meets a facet that stops the light, of
//            another object more than epsilon_m away, or of its own farther away than kOwnReach
//            times the facet's longest edge.
//   fade     As the facets have it, and where a facet faces the light its share fades as the plane
//            comes to lie along the light (Chiang, Li and Burley 2019): kept is -G^3 + G^2 + G with
//            G = min(1, (Ng.L) / ((Ns.L) (Ng.Ns))), Ng the plane's normal, Ns the normal between
//            the corners', L towards the light, all of length 1. Where Ns.L <= 0 or Ng.Ns <= 0 all
//            is kept.
//
// The first lets a ray pass what only stands in for its own curve: in a sphere of radius r, from a
// corner whose normal turns away by less than the facet's angle a, a ray is inside for
// 2 r sin a at the most, and the longest edge is 2 r sin(a / 2) or more.

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "raster/threads/parallel.h"
#include "scenes/scene.h"
#include "scenes/shadows/shadow_mask.h"

namespace softfocus {

inline constexpr double kOwnReach = 2.0;

/// What facets stand in for.
struct CurvedSurfaces {
  /// Of each facet's corners, of length 1 or zero, as its front is lit.
  std::vector<std::array<glm::vec3, 3>> normals;
  std::vector<std::uint32_t> object_of;  ///< of each facet
};

/// A light's pixels as its shadow mask has them.
struct TerminatorLight {
  Terminator rule;
  ShadowLight light;
  int bit;  ///< of the mask
  /// Of each pixel the part of the light's share, in 255ths, that is taken away where the bit is
  /// not set.
  std::span<std::uint8_t> taken;
};

/// The cosines between the light and a facet's corner normals, on the side that is seen.
std::array<double, 3> corner_cosines(const Facets& facets, const CurvedSurfaces& surfaces,
                                     std::uint32_t facet, bool seen_from_back,
                                     const ShadowLight& light);

/// The rule normals: max(c, 0) / c+ at a point of a facet, 0 to 1; 1 where c+ is 0.
double kept_by_normals(const Facet& facet, const FacetPlane& plane,
                       const std::array<double, 3>& cosines, glm::dvec3 point);

/// The rule normals: whether a point with c > 0 of a facet that turns away is in shadow. Asks
/// `casters`.
bool in_shadow_but_for_own_curve(const Facets& facets, const CurvedSurfaces& surfaces,
                                 std::uint32_t facet, glm::dvec3 point, const ShadowLight& light,
                                 std::span<const std::uint32_t> casters);

/// The rule fade: the part of the share that is kept at a point of a facet that faces the light,
/// 0 to 1.
double kept_by_fade(const Facets& facets, const CurvedSurfaces& surfaces, std::uint32_t facet,
                    bool seen_from_back, glm::dvec3 point, const ShadowLight& light);

/// Clears bits of the mask (normals), and adds to `taken`: what stays of the share is what stayed
/// times what the rule keeps, rounded to the nearest 255th.
void soften_terminators(const Facets& facets, const CurvedSurfaces& surfaces,
                        std::span<const TerminatorLight> lights, std::span<const SeenFacet> seen,
                        const ShadowView& view, glm::dvec3 eye, std::span<std::uint8_t> mask,
                        ThreadPool& pool);

}  // namespace softfocus

#pragma once
// The definition of a shadow, as an oracle: a ray from a point towards the light against every
// facet, in binary64.

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "scenes/shadows/facets.h"

namespace softfocus {

/// How many `direction`s away a ray hits a facet, or a negative number (Moeller and Trumbore 1997).
double ray_hit(const Facet& facet, glm::dvec3 from, glm::dvec3 direction);

/// Whether a point on the front or the back of a facet is in shadow. It is if the light does not
/// reach that side (projected_shadows.h, lit_side()), or if the ray from the point to the light
/// meets one of `casters` that stops light, is of another receiver, and is hit more than epsilon_m
/// over the receiver's plane.
bool point_in_shadow(const Facets& facets, std::uint32_t facet, bool seen_from_back,
                     glm::dvec3 point, const ShadowLight& light,
                     std::span<const std::uint32_t> casters);

/// The point of a facet's plane that is seen at a place in the window, in pixels from its upper
/// left corner. `eye` is the camera's.
glm::dvec3 seen_point(const FacetPlane& plane, const glm::dmat4& world_to_clip, glm::dvec3 eye,
                      glm::dvec2 window, int width, int height);

}  // namespace softfocus

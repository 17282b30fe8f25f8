#pragma once
// The weights that the two-pass and the one-pass filter share: equations 10 to 14 of the
// thesis, after Zhou, Chen and Pullen 2007. weights.inl has them in lanes, weights.glsl for
// drivers. A pixel C gathers from its neighbours P; d is their distance in pixels, r the
// radius of a circle of confusion, z depth, z_f the focus distance:
//
//   overlap    O(P) = clamp(r_P - d, 0, 1)         does P's circle reach C?      (10)
//   intensity  I(P) = 1 / max(r_P, 1)^2            light spread over the circle  (11)
//   leakage    L(P) = min(leak * r_C, 1) if z_P > z_f, else 1                    (12)
//   W(C) = I(C)        W(P) = (O(P) * I(P)) * L(P)                         (13), (14)
//   result = sum(W * colour) / sum(W)
//
// The source leaves four things open. Here:
// - (11) is only proportional to 1/r^2. A circle of radius 1 still weighs 1, since O keeps
//   the light of smaller circles in one pixel.
// - max_coc cuts r, not O. A larger circle keeps its soft edge: O falls from 1 to 0 between
//   max_coc - 1 and max_coc, and taps at max_coc or past it weigh 0.
// - The leak factor counts per pixel of the receiver's radius. At 1, the default, a receiver
//   that is a pixel soft takes all of a background; no other factor tried comes nearer to the
//   lens (docs/depth-of-field.md has the figures).
// - A neighbour of weight 0 is left out, not added as 0 * colour: an infinite or NaN pixel
//   then harms only what its own circle covers.

#include <cmath>
#include <glm/vec3.hpp>

#include "dof/dof.h"
#include "dof/lens.h"

namespace softfocus {

/// What a neighbour contributes, computed once a pixel.
struct FilterTexel {
  glm::vec3 colour;
  float radius_px;    ///< 0 to max_coc_px
  float intensity;    ///< I
  bool beyond_focus;  ///< z_P > z_f
};

/// The radius that the filters use: |r|, cut to the largest. A NaN depth is blurred to the
/// largest.
inline float filter_radius(const DofSettings& settings, float depth_m) {
  const float radius = std::fabs(coc_radius_px(settings.coc, depth_m));
  return radius < settings.max_coc_px ? radius : settings.max_coc_px;
}

inline float intensity(float radius_px) {
  const float radius = radius_px > 1.0f ? radius_px : 1.0f;
  return 1.0f / (radius * radius);
}

inline float overlap(float radius_px, float distance_px) {
  const float reach = radius_px - distance_px;
  return reach > 0.0f ? (reach < 1.0f ? reach : 1.0f) : 0.0f;
}

/// The share that a receiver of that radius takes from beyond the focus plane.
inline float leakage(float receiver_radius_px, float leak) {
  const float share = leak * receiver_radius_px;
  return share < 1.0f ? share : 1.0f;
}

/// Cuts a quotient to the range of halves. NaN stays NaN.
inline float clamp_to_half(float value) {
  const float below = value > 65504.0f ? 65504.0f : value;
  return below < -65504.0f ? -65504.0f : below;
}

inline FilterTexel filter_texel(const DofSettings& settings, glm::vec3 colour, float depth_m) {
  const float radius = filter_radius(settings, depth_m);
  return {colour, radius, intensity(radius), depth_m > settings.coc.focus_m};
}

/// The two sums of a gather.
struct Gather {
  glm::vec3 colour;
  float weight;
};

/// The centre's own share (13).
inline Gather begin_gather(const FilterTexel& centre) {
  return {centre.colour * centre.intensity, centre.intensity};
}

/// Adds a neighbour (14). `receiver_leakage` is leakage() of the centre.
inline void add_neighbour(Gather& gather, const FilterTexel& p, float distance_px,
                          float receiver_leakage) {
  const float weight = (overlap(p.radius_px, distance_px) * p.intensity) *
                       (p.beyond_focus ? receiver_leakage : 1.0f);
  if (!(weight > 0.0f)) return;
  gather.colour += p.colour * weight;
  gather.weight += weight;
}

inline glm::vec3 resolve(const Gather& gather) {
  return {clamp_to_half(gather.colour.x / gather.weight),
          clamp_to_half(gather.colour.y / gather.weight),
          clamp_to_half(gather.colour.z / gather.weight)};
}

/// Taps to each side that may weigh something: integer distances 1 <= d < radius.
inline int tap_count(float radius_px) {
  return radius_px > 0.0f ? static_cast<int>(std::ceil(radius_px)) - 1 : 0;
}

}  // namespace softfocus

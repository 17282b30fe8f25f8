#pragma once
// Light at a vertex: ambient, diffuse and specular after Blinn 1977, in binary32 and
// in an order that a shader can follow: no pow, no dot() of unknown order.

#include <glm/vec3.hpp>
#include <span>

#include "raster/numbers/vector_math.h"
#include "scenes/scene.h"

namespace softfocus {

/// x^n for n >= 1 by squaring, from n's lowest bit up: the same products on every
/// machine, where a driver's pow is an approximation.
inline float whole_power(float x, int n) {
  float power = 1.0f;
  for (float square = x; n > 0; n >>= 1, square *= square) {
    if ((n & 1) != 0) power *= square;
  }
  return power;
}

/// What a texture multiplies, and what it does not.
struct LitColour {
  glm::vec3 base;  ///< ambient and diffuse
  glm::vec3 specular;
};

/// Light on a point, all in world space. With n the normal, v towards the eye, l
/// towards a light and h = normalize(l + v), summed over the lights in order:
///   base     = ambient_light * ambient + sum colour * (diffuse * max(n.l, 0))
///   specular = sum colour * (specular * (n.h)^shininess)      where n.l > 0 and n.h > 0
/// `normal` and `towards_eye` have unit length.
inline LitColour light_point(const Material& material, glm::vec3 ambient_light,
                             std::span<const Light> lights, glm::vec3 point, glm::vec3 normal,
                             glm::vec3 towards_eye) {
  LitColour lit{ambient_light * material.ambient, glm::vec3{0.0f}};
  for (const Light& light : lights) {
    const glm::vec3 towards_light =
        normalize(light.kind == LightKind::point ? light.position_or_direction - point
                                                 : light.position_or_direction);
    const float facing = dot(normal, towards_light);
    if (!(facing > 0.0f)) continue;
    lit.base += light.colour * (material.diffuse * facing);
    const float highlight = dot(normal, normalize(towards_light + towards_eye));
    if (highlight > 0.0f) {
      lit.specular +=
          light.colour * (material.specular * whole_power(highlight, material.shininess));
    }
  }
  return lit;
}

}  // namespace softfocus

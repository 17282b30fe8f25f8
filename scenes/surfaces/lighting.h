#pragma once
// Light at a vertex: ambient, diffuse and specular after Blinn 1977, in binary32 and
// in an order that a shader can follow: no pow, no dot() of unknown order.

#include <algorithm>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "raster/numbers/vector_math.h"
#include "scenes/scene.h"

namespace softfocus {

/// x^n for n >= 1 by squaring, from n's lowest bit up: the same products on every
/// machine, where a driver's pow is an approximation. No product goes beyond x^n.
inline float whole_power(float x, int n) {
  float power = 1.0f;
  for (float square = x;; square *= square) {
    if ((n & 1) != 0) power *= square;
    n >>= 1;
    if (n == 0) return power;
  }
}

/// A highlight counts from this cosine on. The powers of smaller ones are below 2^-63 and soon
/// subnormal, which costs CPUs a hundred cycles a product. Its own power is at least 2^-126
/// for n up to 126; above, (1 + 87/n)^-n > e^-87.
inline float least_highlight(int n) {
  if (n > 126) return static_cast<float>(n) / static_cast<float>(n + 87);
  return 1.0f / static_cast<float>(std::uint64_t{1} << std::min(126 / n, 63));
}

/// Apart, because a texture multiplies the base alone.
struct LitColour {
  glm::vec3 base;  ///< ambient and diffuse
  glm::vec3 specular;
};

/// Light on a point, all in world space. With n the normal, v towards the eye, l
/// towards a light and h = normalize(l + v), summed over the lights in order:
///   base     = ambient_light * ambient + sum colour * (diffuse * max(n.l, 0))
///   specular = sum colour * (specular * (n.h)^shininess)
///              where n.l > 0 and n.h >= least_highlight(shininess)
/// `normal` and `towards_eye` have unit length.
inline LitColour light_point(const Material& material, glm::vec3 ambient_light,
                             std::span<const Light> lights, glm::vec3 point, glm::vec3 normal,
                             glm::vec3 towards_eye) {
  LitColour lit{ambient_light * material.ambient, glm::vec3{0.0f}};
  const float least = least_highlight(material.shininess);
  for (const Light& light : lights) {
    const glm::vec3 towards_light =
        normalize(light.kind == LightKind::point ? light.position_or_direction - point
                                                 : light.position_or_direction);
    const float facing = dot(normal, towards_light);
    if (!(facing > 0.0f)) continue;
    lit.base += light.colour * (material.diffuse * facing);
    const float highlight = dot(normal, normalize(towards_light + towards_eye));
    if (highlight >= least) {
      lit.specular +=
          light.colour * (material.specular * whole_power(highlight, material.shininess));
    }
  }
  return lit;
}

}  // namespace softfocus

#pragma once
// The world about a camera's eye, in pixels.

#include <array>
#include <glm/vec3.hpp>

#include "scenes/shadows/facets.h"
#include "scenes/shadows/shadow_mask.h"

namespace softfocus {

/// f(x, y) = a x + b y + c, in this order.
struct Linear {
  double a, b, c;
};

inline double at(const Linear& f, double x, double y) { return (f.a * x + f.b * y) + f.c; }

/// Corners (x, y, w) about the eye: x / w and y / w are pixels from the picture's upper left
/// corner, w is the depth along the axis.
struct PixelSpace {
  glm::dvec3 eye;
  std::array<glm::dvec3, 3> rows;     // of the matrix from the world to x, y and w
  std::array<glm::dvec3, 3> columns;  // of its inverse
  double least_w;                     // of a sample
  double facing;                      // det(v_0, v_1, v_2) has this sign for what faces the eye
};

PixelSpace pixel_space(const ShadowView& view, glm::dvec3 eye);

glm::dvec3 to_pixels(const PixelSpace& space, glm::dvec3 from_eye);
glm::dvec3 from_pixels(const PixelSpace& space, glm::dvec3 v);
glm::dvec3 to_light(const PixelSpace& space, const ShadowLight& light);

}  // namespace softfocus

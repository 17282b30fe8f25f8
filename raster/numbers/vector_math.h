#pragma once
// Products of GLM's vectors and matrices in a written-down order. GLM gives the
// types and the componentwise operators, which can only be computed in one way;
// sums of products can be computed in several, and GLM's versions differ in which.

#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace softfocus {

/// (x x' + y y') + z z'
inline float dot(glm::vec3 a, glm::vec3 b) { return (a.x * b.x + a.y * b.y) + a.z * b.z; }
inline double dot(glm::dvec3 a, glm::dvec3 b) { return (a.x * b.x + a.y * b.y) + a.z * b.z; }

inline glm::vec3 cross(glm::vec3 a, glm::vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline glm::dvec3 cross(glm::dvec3 a, glm::dvec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// v divided by its length, component by component; the zero vector stays zero.
inline double length_of(glm::dvec3 v) { return std::sqrt(dot(v, v)); }

inline glm::vec3 normalize(glm::vec3 v) {
  const float length = std::sqrt(dot(v, v));
  return length > 0.0f ? glm::vec3{v.x / length, v.y / length, v.z / length} : glm::vec3{0.0f};
}
inline glm::dvec3 normalize(glm::dvec3 v) {
  const double length = std::sqrt(dot(v, v));
  return length > 0.0 ? glm::dvec3{v.x / length, v.y / length, v.z / length} : glm::dvec3{0.0};
}

/// matrix * (point, 1): ((column0 x + column1 y) + column2 z) + column3.
inline glm::vec4 transform_point(const glm::mat4& m, glm::vec3 p) {
  return ((m[0] * p.x + m[1] * p.y) + m[2] * p.z) + m[3];
}

/// (column0 x + column1 y) + column2 z.
inline glm::vec3 transform_direction(const glm::mat3& m, glm::vec3 d) {
  return (m[0] * d.x + m[1] * d.y) + m[2] * d.z;
}

/// The product a * b in binary64, each element summed over k = 0..3 in order.
inline glm::dmat4 multiply(const glm::dmat4& a, const glm::dmat4& b) {
  glm::dmat4 product{0.0};
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) {
      double sum = a[0][row] * b[column][0];
      for (int k = 1; k < 4; ++k) sum += a[k][row] * b[column][k];
      product[column][row] = sum;
    }
  }
  return product;
}

}  // namespace softfocus

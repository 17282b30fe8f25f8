#pragma once
// Depth and varyings at a pixel of a triangle, in the two ways that profiles name.

#include <array>
#include <cstddef>
#include <cstdint>

#include "raster/numbers/lerp.h"
#include "raster/pipeline/setup.h"
#include "raster/pipeline/stages.h"

namespace softfocus {

/// A triangle ready for its pixels.
template <std::size_t N>
struct Triangle {
  TriangleSetup setup;
  std::array<Varyings<N>, 3> varyings;
};

template <std::size_t N>
struct Interpolated {
  float depth;
  Varyings<N> varyings;
};

/// By barycentric weights from the exact edge functions E_0, E_1, E_2 at the pixel:
///   l_i = float(E_i) * (1 / float(area))                            linear weights
///   p_i = l_i * inverse_w_i;  s = (p_0 + p_1) + p_2;  q_i = p_i * (1 / s)
///   value = (a_0 + w_1 (a_1 - a_0)) + w_2 (a_2 - a_0)      w = l linear, q perspective
/// Inside the triangle every l_i and p_i is at least 0 and s positive, whatever the
/// sliver; a varying that is the same at all three vertices comes out unchanged.
template <std::size_t N>
struct BarycentricInterpolator {
  const Triangle<N>& triangle;
  float inverse_area;

  BarycentricInterpolator(const Triangle<N>& t, const Profile&)
      : triangle(t), inverse_area(1.0f / static_cast<float>(t.setup.area)) {}

  Interpolated<N> at(int x, int y, const std::array<Interpolation, N>& kinds) const {
    const auto& v = triangle.setup.vertices;
    const auto weight = [&](std::size_t i) {
      return static_cast<float>(edge_at(triangle.setup.edges[i], x, y)) * inverse_area;
    };
    const float l0 = weight(0);
    const float l1 = weight(1);
    const float l2 = weight(2);
    const float p1 = l1 * v[1].inverse_w;
    const float p2 = l2 * v[2].inverse_w;
    const float reciprocal = 1.0f / ((l0 * v[0].inverse_w + p1) + p2);
    const float q1 = p1 * reciprocal;
    const float q2 = p2 * reciprocal;

    const auto blend = [](float a0, float a1, float a2, float w1, float w2) {
      return (a0 + w1 * (a1 - a0)) + w2 * (a2 - a0);
    };
    Interpolated<N> result;
    result.depth = blend(v[0].depth, v[1].depth, v[2].depth, l1, l2);
    for (std::size_t i = 0; i < N; ++i) {
      const float a0 = triangle.varyings[0][i];
      const float a1 = triangle.varyings[1][i];
      const float a2 = triangle.varyings[2][i];
      switch (kinds[i]) {
        case Interpolation::perspective: result.varyings[i] = blend(a0, a1, a2, q1, q2); break;
        case Interpolation::linear: result.varyings[i] = blend(a0, a1, a2, l1, l2); break;
        case Interpolation::flat: result.varyings[i] = a0; break;
      }
    }
    return result;
  }
};

/// By plane equations from the unsnapped positions, evaluated from the framebuffer's
/// origin: a(x, y) = (a_origin + dadx x) + dady y at pixel (x, y), the products fused
/// as the profile says. Perspective varyings are set up as a / w, and divided by the
/// plane of 1 / w.
template <std::size_t N>
struct PlaneInterpolator {
  struct Plane {
    float at_origin;
    float per_x;
    float per_y;
  };
  const Triangle<N>& triangle;
  Contraction contraction;
  float dy20_over_area;
  float dy01_over_area;
  float dx20_over_area;
  float dx01_over_area;

  PlaneInterpolator(const Triangle<N>& t, const Profile& profile)
      : triangle(t), contraction(profile.interpolation) {
    const auto& v = t.setup.vertices;
    const float dx01 = v[0].x - v[1].x;
    const float dy01 = v[0].y - v[1].y;
    const float dx20 = v[2].x - v[0].x;
    const float dy20 = v[2].y - v[0].y;
    const float one_over_area = 1.0f / (dx01 * dy20 - dx20 * dy01);
    dy20_over_area = dy20 * one_over_area;
    dy01_over_area = dy01 * one_over_area;
    dx20_over_area = dx20 * one_over_area;
    dx01_over_area = dx01 * one_over_area;
  }

  Plane plane(float a0, float a1, float a2) const {
    const auto& v = triangle.setup.vertices;
    const float da01 = a0 - a1;
    const float da20 = a2 - a0;
    const float per_x = da01 * dy20_over_area - da20 * dy01_over_area;
    const float per_y = da20 * dx01_over_area - da01 * dx20_over_area;
    const float at_origin = a0 - (per_x * (v[0].x - 0.5f) + per_y * (v[0].y - 0.5f));
    return {at_origin, per_x, per_y};
  }

  float evaluate(const Plane& p, int x, int y) const {
    const float along_x = multiply_add(p.per_x, static_cast<float>(x), p.at_origin, contraction);
    return multiply_add(p.per_y, static_cast<float>(y), along_x, contraction);
  }

  Interpolated<N> at(int x, int y, const std::array<Interpolation, N>& kinds) const {
    const auto& v = triangle.setup.vertices;
    const float inverse_w = evaluate(plane(v[0].inverse_w, v[1].inverse_w, v[2].inverse_w), x, y);
    const float w = 1.0f / inverse_w;
    Interpolated<N> result;
    result.depth = evaluate(plane(v[0].depth, v[1].depth, v[2].depth), x, y);
    for (std::size_t i = 0; i < N; ++i) {
      const float a0 = triangle.varyings[0][i];
      const float a1 = triangle.varyings[1][i];
      const float a2 = triangle.varyings[2][i];
      switch (kinds[i]) {
        case Interpolation::perspective:
          result.varyings[i] =
              w *
              evaluate(plane(a0 * v[0].inverse_w, a1 * v[1].inverse_w, a2 * v[2].inverse_w), x, y);
          break;
        case Interpolation::linear: result.varyings[i] = evaluate(plane(a0, a1, a2), x, y); break;
        case Interpolation::flat: result.varyings[i] = a0; break;
      }
    }
    return result;
  }
};

}  // namespace softfocus

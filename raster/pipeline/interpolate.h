#pragma once
// Depth and varyings at a pixel of a triangle, for each AttributeSetup. An interpolator refers
// to its triangle and to the kinds of its varyings.

#include <array>
#include <cstddef>
#include <glm/vec2.hpp>
#include <variant>

#include "raster/numbers/profile.h"
#include "raster/pipeline/planes.h"
#include "raster/pipeline/setup.h"
#include "raster/pipeline/stages.h"

namespace softfocus {

/// A triangle ready for its pixels.
template <std::size_t N>
struct Triangle {
  TriangleSetup setup;
  std::array<Varyings<N>, 3> varyings;
  std::size_t provoking;  ///< the vertex that flat varyings come from: 0 or 2
};

template <std::size_t N>
struct Interpolated {
  float depth;
  Varyings<N> varyings;
};

/// All of a pixel, at a place from its centre in 1/256 pixel.
template <std::size_t N, class Interpolator>
Interpolated<N> interpolated(const Interpolator& interpolator, int x, int y,
                             const glm::ivec2& place) {
  const auto pixel = interpolator.pixel(x, y, place);
  Interpolated<N> result;
  result.depth = interpolator.depth(pixel);
  for (std::size_t i = 0; i < N; ++i) result.varyings[i] = interpolator.varying(pixel, i);
  return result;
}

/// By barycentric weights from the exact edge functions E_0, E_1, E_2 at the pixel:
///   l_i = float(E_i) * (1 / float(area))                            linear weights
///   p_i = l_i * inverse_w_i;  s = (p_0 + p_1) + p_2;  q_i = p_i * (1 / s)
///   value = (a_0 + w_1 (a_1 - a_0)) + w_2 (a_2 - a_0)      w = l linear, q perspective
/// Inside the triangle every l_i and p_i is at least 0 and s is positive, even in slivers. A
/// varying that is equal at all three vertices comes out unchanged. Needs
/// Coverage::edge_functions.
template <std::size_t N>
struct BarycentricInterpolator {
  const Triangle<N>& triangle;
  const std::array<Interpolation, N>& kinds;
  const EdgeFunctions& functions;
  float inverse_area;

  BarycentricInterpolator(const Triangle<N>& t, const Profile&,
                          const std::array<Interpolation, N>& interpolation)
      : triangle(t),
        kinds(interpolation),
        functions(std::get<EdgeFunctions>(t.setup.coverage)),
        inverse_area(1.0f / static_cast<float>(functions.area)) {}

  /// A pixel's weights: l_1, l_2, q_1, q_2; and 1 / w there.
  struct Pixel {
    float l1, l2, q1, q2;
    float inverse_w;
  };

  Pixel pixel(int x, int y, const glm::ivec2& place = {}) const {
    const auto& v = triangle.setup.vertices;
    const auto weight = [&](std::size_t i) {
      return static_cast<float>(edge_at(functions.edges[i], x, y, place)) * inverse_area;
    };
    const float l0 = weight(0);
    const float l1 = weight(1);
    const float l2 = weight(2);
    const float p1 = l1 * v[1].inverse_w;
    const float p2 = l2 * v[2].inverse_w;
    const float inverse_w = (l0 * v[0].inverse_w + p1) + p2;
    const float reciprocal = 1.0f / inverse_w;
    return {l1, l2, p1 * reciprocal, p2 * reciprocal, inverse_w};
  }

  float depth(const Pixel& at) const {
    const auto& v = triangle.setup.vertices;
    return blend(v[0].depth, v[1].depth, v[2].depth, at.l1, at.l2);
  }

  float varying(const Pixel& at, std::size_t i) const {
    const float a0 = triangle.varyings[0][i];
    const float a1 = triangle.varyings[1][i];
    const float a2 = triangle.varyings[2][i];
    switch (kinds[i]) {
      case Interpolation::perspective: return blend(a0, a1, a2, at.q1, at.q2);
      case Interpolation::linear: return blend(a0, a1, a2, at.l1, at.l2);
      case Interpolation::flat: break;
    }
    return triangle.varyings[triangle.provoking][i];
  }

  Interpolated<N> at(int x, int y, const glm::ivec2& place = {}) const {
    return interpolated<N>(*this, x, y, place);
  }

 private:
  static float blend(float a0, float a1, float a2, float w1, float w2) {
    return (a0 + w1 * (a1 - a0)) + w2 * (a2 - a0);
  }
};

/// By planes over the window (planes.h). A perspective varying is the plane of a / w divided by
/// that of 1 / w, which is the centre's wherever the varying is wanted, as in llvmpipe.
template <class Planes, std::size_t N>
struct PlaneInterpolator {
  const std::array<Interpolation, N>& kinds;
  Planes planes;
  Plane depth_plane;
  Plane inverse_w;
  std::array<Plane, N> varyings;

  PlaneInterpolator(const Triangle<N>& triangle, const Profile& profile,
                    const std::array<Interpolation, N>& interpolation)
      : kinds(interpolation), planes(triangle.setup, triangle.provoking, profile) {
    const auto& v = triangle.setup.vertices;
    depth_plane = planes.plane({v[0].depth, v[1].depth, v[2].depth});
    inverse_w = planes.plane({v[0].inverse_w, v[1].inverse_w, v[2].inverse_w});
    for (std::size_t i = 0; i < N; ++i) {
      const float a0 = triangle.varyings[0][i];
      const float a1 = triangle.varyings[1][i];
      const float a2 = triangle.varyings[2][i];
      switch (kinds[i]) {
        case Interpolation::perspective:
          varyings[i] =
              planes.plane({a0 * v[0].inverse_w, a1 * v[1].inverse_w, a2 * v[2].inverse_w});
          break;
        case Interpolation::linear: varyings[i] = planes.plane({a0, a1, a2}); break;
        case Interpolation::flat:
          varyings[i] = {triangle.varyings[triangle.provoking][i], 0.0f, 0.0f};
          break;
      }
    }
  }

  struct Pixel {
    int x, y;
    glm::ivec2 place;
    float inverse_w;
  };

  Pixel pixel(int x, int y, const glm::ivec2& place = {}) const {
    return {x, y, place, planes.at(inverse_w, x, y)};
  }

  float depth(const Pixel& at) const { return planes.at(depth_plane, at.x, at.y, at.place); }

  float varying(const Pixel& at, std::size_t i) const {
    switch (kinds[i]) {
      case Interpolation::perspective:
        return Planes::divide(planes.at(varyings[i], at.x, at.y, at.place), at.inverse_w);
      case Interpolation::linear: return planes.at(varyings[i], at.x, at.y, at.place);
      case Interpolation::flat: break;
    }
    return varyings[i].at_origin;
  }

  Interpolated<N> at(int x, int y, const glm::ivec2& place = {}) const {
    return interpolated<N>(*this, x, y, place);
  }
};

}  // namespace softfocus

#pragma once
// Attributes as planes over the window, a(x, y) = at_origin + x * per_x + y * per_y at pixel
// (x, y): set up from unsnapped positions and rounded as in two drivers of Mesa 22.3. Of several
// samples a pixel the origin is the window's corner, of one it is the first pixel's centre.

#include <array>
#include <cstddef>
#include <glm/vec2.hpp>
#include <utility>

#include "raster/numbers/lerp.h"
#include "raster/numbers/profile.h"
#include "raster/pipeline/setup.h"

namespace softfocus {

struct Plane {
  float at_origin;
  float per_x;
  float per_y;
};

/// llvmpipe. First, in a clockwise triangle, the two vertices that are not provoking change
/// places. Differences over area are rounded once, for all attributes. Products at a pixel are
/// fused as the profile's `interpolation` says, products of set-up never.
struct PlanesFromOrigin {
  std::array<std::size_t, 3> order;
  float x0, y0;  // from the origin
  float centre;  // of pixel (0, 0), from there
  float dx01_over_area, dy01_over_area;
  float dx20_over_area, dy20_over_area;
  Contraction contraction;

  PlanesFromOrigin(const TriangleSetup& setup, std::size_t provoking, const Profile& profile)
      : order{0, 1, 2}, contraction(profile.interpolation) {
    if (setup.clockwise) std::swap(order[1], order[provoking == 0 ? 2 : 0]);
    const WindowVertex& v0 = setup.vertices[order[0]];
    const WindowVertex& v1 = setup.vertices[order[1]];
    const WindowVertex& v2 = setup.vertices[order[2]];
    const float dx01 = v0.x - v1.x;
    const float dy01 = v0.y - v1.y;
    const float dx20 = v2.x - v0.x;
    const float dy20 = v2.y - v0.y;
    const float one_over_area = 1.0f / (dx01 * dy20 - dx20 * dy01);
    centre = setup.samples == 1 ? 0.0f : 0.5f;
    x0 = v0.x - (0.5f - centre);
    y0 = v0.y - (0.5f - centre);
    dx01_over_area = dx01 * one_over_area;
    dy01_over_area = dy01 * one_over_area;
    dx20_over_area = dx20 * one_over_area;
    dy20_over_area = dy20 * one_over_area;
  }

  Plane plane(const std::array<float, 3>& by_vertex) const {
    const float a0 = by_vertex[order[0]];
    const float da01 = a0 - by_vertex[order[1]];
    const float da20 = by_vertex[order[2]] - a0;
    const float per_x = da01 * dy20_over_area - da20 * dy01_over_area;
    const float per_y = da20 * dx01_over_area - da01 * dx20_over_area;
    return {a0 - (per_x * x0 + per_y * y0), per_x, per_y};
  }

  /// `place`: from the pixel's centre, in 1/256 pixel.
  float at(const Plane& p, int x, int y, const glm::ivec2& place = {}) const {
    const auto from_origin = [&](int pixel, int from_centre) {
      return static_cast<float>(pixel) + (centre + static_cast<float>(from_centre) / 256.0f);
    };
    const float along_x = multiply_add(p.per_x, from_origin(x, place.x), p.at_origin, contraction);
    return multiply_add(p.per_y, from_origin(y, place.y), along_x, contraction);
  }

  /// A perspective varying, from the planes of a / w and 1 / w.
  static float divide(float over_w, float inverse_w) { return over_w * (1.0f / inverse_w); }
};

/// softpipe, which has one sample a pixel. The vertices are sorted from top to bottom. The plane is
/// evaluated at the upper left pixel of a 2x2 block (even x, even y) and stepped to the other
/// three.
struct PlanesByQuad {
  std::array<std::size_t, 3> order;
  float x0, y0;                      // from the centre of pixel (0, 0)
  float dx_to_middle, dy_to_middle;  // from the top vertex
  float dx_to_bottom, dy_to_bottom;
  float one_over_area;

  PlanesByQuad(const TriangleSetup& setup, std::size_t, const Profile&)
      : order(from_top_to_bottom(setup.vertices)) {
    const WindowVertex& top = setup.vertices[order[0]];
    const WindowVertex& middle = setup.vertices[order[1]];
    const WindowVertex& bottom = setup.vertices[order[2]];
    x0 = top.x - 0.5f;
    y0 = top.y - 0.5f;
    dx_to_middle = middle.x - top.x;
    dy_to_middle = middle.y - top.y;
    dx_to_bottom = bottom.x - top.x;
    dy_to_bottom = bottom.y - top.y;
    one_over_area = 1.0f / (dx_to_bottom * dy_to_middle - dx_to_middle * dy_to_bottom);
  }

  Plane plane(const std::array<float, 3>& by_vertex) const {
    const float a0 = by_vertex[order[0]];
    const float to_middle = by_vertex[order[1]] - a0;
    const float to_bottom = by_vertex[order[2]] - a0;
    const float per_x = (dy_to_middle * to_bottom - to_middle * dy_to_bottom) * one_over_area;
    const float per_y = (dx_to_bottom * to_middle - to_bottom * dx_to_middle) * one_over_area;
    return {a0 - (per_x * x0 + per_y * y0), per_x, per_y};
  }

  float at(const Plane& p, int x, int y, const glm::ivec2& = {}) const {
    float value =
        (p.at_origin + p.per_x * static_cast<float>(x & ~1)) + p.per_y * static_cast<float>(y & ~1);
    if ((x & 1) != 0) value += p.per_x;
    if ((y & 1) != 0) value += p.per_y;
    return value;
  }

  /// A perspective varying, from the planes of a / w and 1 / w.
  static float divide(float over_w, float inverse_w) { return over_w / inverse_w; }
};

}  // namespace softfocus

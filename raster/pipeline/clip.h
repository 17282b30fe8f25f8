#pragma once
// Clipping in homogeneous coordinates, before the division by w (Sutherland and Hodgman 1974).
// The planes, in the order in which they cut: x = g w, x = -g w, y = g w, y = -g w, near z = -w,
// far z = w. g is the guard band: if it is wide, most triangles across the picture's edge are
// not cut, but scissored per pixel. Order and arithmetic are those of Mesa's drivers: with g = 1
// new vertices are the same to the bit.

#include <array>
#include <cstddef>
#include <glm/vec4.hpp>
#include <span>

#include "raster/numbers/profile.h"
#include "raster/pipeline/stages.h"

namespace softfocus {

struct ClipVertex {
  glm::vec4 position;
  std::array<float, kMaxVaryings> varyings;
  bool is_new = false;  ///< made by clipping
};

/// A convex polygon, apart from rounding. In exact arithmetic each plane adds at most one vertex.
/// But the rounded vertices of a sliver can lie on alternate sides of a plane, and n vertices
/// then become 3n/2: 3, 4, 6, 9, 13, 19, 28.
struct ClipPolygon {
  std::array<ClipVertex, 28> vertices;
  std::size_t count = 0;
};

/// A bit for each plane that the point is outside of, in the order above: bit 0 is x = g w. A
/// point with a NaN or infinite component has kNotFinite alone.
inline constexpr unsigned kNotFinite = 1u << 6;
unsigned clip_code(const glm::vec4& position, float guard_band);

/// Cuts the polygon by the planes whose bit is set. Let a and b be the ends of an edge, with
/// signed distances d_a and d_b to the plane, a the nearer one (|d_a| < |d_b|; if they are equal,
/// the one inside). The new vertex has position and varyings a + t (b - a), t = d_a / (d_a - d_b).
/// It does not depend on the direction of the edge, so two triangles with a common edge get the
/// same point. Flat varyings are those of the end inside. For linear ones t is the place between
/// the images of a and b in the window, t w_b / w. Clipping::mesa takes it from the images' x
/// instead, or from their y if both ends have the same clip x. It is NaN on an edge that is seen
/// upright, as on the picture's left and right side.
/// A polygon that is cut away, or at an infinite distance from a plane, has count 0.
void clip_polygon(ClipPolygon& polygon, unsigned planes, std::span<const Interpolation> varyings,
                  const Profile& profile);

}  // namespace softfocus

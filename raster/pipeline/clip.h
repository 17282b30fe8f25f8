#pragma once
// Clipping in homogeneous coordinates, before the division by w (Sutherland and
// Hodgman 1974). Planes, in the order in which they cut: x = g w, x = -g w, y = g w,
// y = -g w, near z = -w, far z = w, g the guard band: where it is wide, most triangles
// across the picture's edge are not cut at all, but scissored per pixel. Order and
// arithmetic are those of Mesa's drivers: with g = 1 the new vertices are theirs to the
// bit.

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

/// A polygon, convex but for rounding. In exact arithmetic each of the six planes adds
/// at most one vertex to a triangle; but the rounded vertices of a sliver can lie on
/// alternate sides of a plane, and n vertices then become 3n/2: 3, 4, 6, 9, 13, 19, 28.
struct ClipPolygon {
  std::array<ClipVertex, 28> vertices;
  std::size_t count = 0;
};

/// One bit for each plane (bit 0: x = g w, in the order above) that the point is outside
/// of. A point with a NaN or infinite component is outside of kNotFinite.
inline constexpr unsigned kNotFinite = 1u << 6;
unsigned clip_code(const glm::vec4& position, float guard_band);

/// Cuts the polygon by the planes whose bit is set. A new vertex on the edge between a
/// and b, whose signed distances to the plane are d_a and d_b, starts from the nearer
/// end (|d_a| < |d_b|, or the one inside if they are equal): a + t (b - a), for position
/// and varyings, with t = d_a / (d_a - d_b). That is the same whichever way round a
/// triangle goes, so two triangles with a common edge get the same point. Flat varyings
/// are those of the end inside. For linear ones t is how far the vertex lies between the
/// images of a and b in the window: t w_b / w. Clipping::mesa takes it from the images' x instead,
/// or their y if both ends have the same clip x; it has no value (NaN) on an edge that
/// is seen upright, as those along the picture's left and right side are.
/// A polygon that is cut away, or is at an infinite distance from a plane, has count 0.
void clip_polygon(ClipPolygon& polygon, unsigned planes, std::span<const Interpolation> varyings,
                  const Profile& profile);

}  // namespace softfocus

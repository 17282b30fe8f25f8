#pragma once
// Clipping in homogeneous coordinates, before the division by w (Sutherland and
// Hodgman 1974). Planes, in the order in which they cut: near z = -w, far z = w,
// left x = -g w, right x = g w, top y = -g w, bottom y = g w, g the guard band: most
// triangles across the picture's edge are not cut at all, but scissored per pixel.

#include <array>
#include <cstddef>
#include <glm/vec4.hpp>
#include <span>

#include "raster/pipeline/stages.h"

namespace softfocus {

struct ClipVertex {
  glm::vec4 position;
  std::array<float, kMaxVaryings> varyings;
};

/// A polygon, convex but for rounding. In exact arithmetic each of the six planes adds
/// at most one vertex to a triangle; but the rounded vertices of a sliver can lie on
/// alternate sides of a plane, and n vertices then become 3n/2: 3, 4, 6, 9, 13, 19, 28.
struct ClipPolygon {
  std::array<ClipVertex, 28> vertices;
  std::size_t count = 0;
};

/// One bit for each plane (bit 0: near, in the order above) that the point is outside
/// of. A point with a NaN or infinite component is outside of kNotFinite.
inline constexpr unsigned kNotFinite = 1u << 6;
unsigned clip_code(const glm::vec4& position, float guard_band);

/// Cuts the polygon by the planes whose bit is set. A new vertex lies on the edge from
/// the inside vertex a to the outside one b at t = d_a / (d_a - d_b), d the plane's
/// signed distance: always from the inside, so that two triangles with a common edge
/// get the same point. Varyings follow a + t (b - a), `linear` ones with t mapped to
/// the window. A polygon that is cut away has count 0.
void clip_polygon(ClipPolygon& polygon, unsigned planes, float guard_band,
                  std::span<const Interpolation> varyings);

}  // namespace softfocus

#pragma once
// Exact coverage (Pineda 1988): vertices are snapped to the subpixel grid; each edge has a
// linear function in 64-bit integers, positive on the triangle's side.

#include <array>
#include <cstdint>
#include <optional>

#include "raster/numbers/profile.h"
#include "raster/pipeline/state.h"
#include "raster/pipeline/viewport.h"

namespace softfocus {

/// The function of one edge,
///   E(x, y) = at_origin + x * per_x + y * per_y
/// at the centre of pixel (x, y), counts 1/65536 of a square pixel.
struct EdgeFunction {
  std::int64_t at_origin;
  std::int64_t per_x;
  std::int64_t per_y;
  bool owns_centres;  ///< a centre exactly on the edge (E = 0) is inside
};

/// Edge i lies opposite to vertex i, and E_0 + E_1 + E_2 = area. Left edges own the centres on
/// them; of level edges the upper or the lower one does, as the profile's fill rule says.
struct EdgeFunctions {
  std::array<EdgeFunction, 3> edges;
  std::int64_t area;  ///< twice the triangle's, in 1/65536 of a square pixel; positive
  bool clockwise;     ///< the order of the vertices, as seen in the picture
  Rectangle bounds;   ///< the pixels whose centres the bounding box holds
};

inline std::int64_t edge_at(const EdgeFunction& edge, int x, int y) {
  return edge.at_origin + x * edge.per_x + y * edge.per_y;
}

inline bool inside(const EdgeFunction& edge, std::int64_t value) {
  return value > 0 || (value == 0 && edge.owns_centres);
}

/// Positions are snapped by round-to-nearest-even of (window - 0.5) * 2^subpixel_bits,
/// both operations in binary32. Needs |x|, |y| <= 2^20. Nothing for a triangle of no area.
std::optional<EdgeFunctions> make_edge_functions(const std::array<WindowVertex, 3>& vertices,
                                                 const Profile& profile);

/// The covered pixels of row y among x_begin <= x < x_end: one span, as a triangle is convex.
Span covered_span(const EdgeFunctions& functions, int y, int x_begin, int x_end);

}  // namespace softfocus

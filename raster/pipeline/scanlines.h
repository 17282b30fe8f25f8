#pragma once
// Coverage by spans between floating-point edges, as in Mesa's softpipe (22.3, sp_setup.c). The
// triangle is cut at its middle vertex into an upper and a lower half; each half is filled row by
// row from its left edge to its right one. Positions are not snapped, nothing is fused.

#include <array>
#include <cstddef>
#include <optional>

#include "raster/pipeline/state.h"
#include "raster/pipeline/viewport.h"

namespace softfocus {

/// An edge of a half, walked downwards. In the half's row r, the first pixel whose centre is on
/// its right is trunc(x + r * per_row); x includes the 1/2 that rounds up.
struct EdgeWalk {
  float x;
  float per_row;
};

/// Rows y_begin <= y < y_end.
struct HalfTriangle {
  int y_begin;
  int y_end;
  EdgeWalk left;
  EdgeWalk right;
};

struct Scanlines {
  std::array<HalfTriangle, 2> halves;  ///< the upper one, then the lower one
  bool clockwise;                      ///< the order of the vertices, as seen in the picture
  Rectangle bounds;                    ///< all spans are within
};

/// The vertices' numbers from the least y to the greatest. If two are equal, the lower number
/// comes first, except that vertex 2 comes first if it shares the least y.
std::array<std::size_t, 3> from_top_to_bottom(const std::array<WindowVertex, 3>& vertices);

/// Needs |x|, |y| <= 2^20. Nothing for a triangle whose area has no finite reciprocal.
std::optional<Scanlines> make_scanlines(const std::array<WindowVertex, 3>& vertices);

/// The covered pixels of row y among x_begin <= x < x_end; needs x_begin >= 0.
Span covered_span(const Scanlines& scanlines, int y, int x_begin, int x_end);

}  // namespace softfocus

#pragma once
// A regular polygon in the circle of confusion, a corner up, as the spans of scatter_discs.h.

#include "dof/scatter/scatter_discs.h"

namespace softfocus {

/// Rows at |dy| above and below the middle; a disc is one that is the same both ways. Both have the
/// weights of the whole.
struct PolygonSpans {
  ScatterDiscs above, below;
};

/// For radii up to `largest_px`, 0 to kLargestMaxCoc, and those that `used` has a 1 for.
PolygonSpans make_polygon_spans(int corners, float largest_px, std::span<const std::uint8_t> used);

}  // namespace softfocus

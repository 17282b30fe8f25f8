#pragma once
// Depths on their way through a picture of halves.
//
// A half has 11 bits, so a circle r = R (z - f) / z, with the horizon's R and the focus f, is known
// to (R - r) / 2048 pixels. That is little, but where all that is in the picture lies near the
// focus of a strong lens, as in a close-up, and R is hundreds of pixels. Another lens R' < R has
// the same circles at other depths,
//
//   z' = f' R' / (R' - r)
//
// of the same order, and to (R' - r) / 2048 pixels. R' needs to be above the largest circle behind
// the focus, no more.

#include <optional>

#include "dof/lens.h"
#include "tools/refocus/depth_map.h"

namespace softfocus {

/// Replaces depths, finite ones, by those of the other lens, and returns it; or leaves them, where
/// circles are known to a 32nd of a pixel in focus, or the other lens would not halve the error.
std::optional<PixelCoc> with_finer_depths(DepthMap& map, const PixelCoc& coc);

}  // namespace softfocus

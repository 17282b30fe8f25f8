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
#include <span>

#include "dof/lens.h"
#include "tools/refocus/depth/depth_map.h"

namespace softfocus {

/// The other lens, and the way from depths of the one to those of the other.
struct FinerLens {
  double far_px, focus_m;  ///< R, f
  double other_px;         ///< R'
  PixelCoc coc;            ///< R', f'
};

/// For depths between two finite ones. None where circles are known to a 32nd of a pixel in focus,
/// or the other lens would not halve the error.
std::optional<FinerLens> finer_lens(float nearest_m, float farthest_m, const PixelCoc& coc);

void to_finer_depths(std::span<float> metres, const FinerLens& lens);

/// Replaces depths, finite ones, by those of the other lens, and returns it; or leaves them.
std::optional<PixelCoc> with_finer_depths(DepthMap& map, const PixelCoc& coc);

}  // namespace softfocus

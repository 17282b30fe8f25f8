#pragma once
// A relief at half its resolution, and again: the levels of a relief that was drawn finer than it
// is seen now (4.1.1 of Clua 2004). A warp takes the coarsest whose texels are no wider than
// pixels, and so wastes no work.

#include "scenes/relief/relief_texture.h"

namespace softfocus {

/// Half as many texels each way, rounded up. If at least two of four texels show something, the new
/// texel has the depth and the normal of the nearest, as an outline is the nearer surface's, and
/// the mean of the colours of those whose depths are within kSameSurface of it. Needs more than a
/// texel each way.
ReliefTexture coarser_relief(const ReliefTexture& relief);

/// Of all depths.
inline constexpr double kSameSurface = 1.0 / 16.0;

}  // namespace softfocus

#pragma once
// A relief at half its resolution, and again: the levels of a relief that was drawn finer than it
// is seen now (4.1.1 of Clua 2004). A warp takes the coarsest whose texels are still no wider than
// pixels, and so does no work that is lost.

#include "scenes/relief/relief_texture.h"

namespace softfocus {

/// Half as many texels each way, rounded up. Of four texels at least two must show something. Then
/// theirs is the depth of the nearest, as an outline is the nearer surface's, with its normal, and
/// the mean of the colours of those whose depths are within kSameSurface of it. Needs more than a
/// texel each way.
ReliefTexture coarser_relief(const ReliefTexture& relief);

/// Of all depths.
inline constexpr double kSameSurface = 1.0 / 16.0;

}  // namespace softfocus

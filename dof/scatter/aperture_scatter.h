#pragma once
// scatter-aperture: scatter-sorted (scatter.h) with the aperture's exact image.
//
//   w_P(Q) = share of pixel Q that the image of P's aperture covers / sum of these shares
//
// The image is a disc, a regular polygon, or either stretched (dof/lens.h), of any radius:
// where all depths are equal the result is the convolution with it, within 1e-4 of a colour of 1.
// Slabs, and what lies over what, are those of scatter-sorted, and so are the failures.
//
// A row of a stamp is two runs of differences, at its edges; one running sum over the row turns
// differences into light. That takes about 8 r + 8 additions a pixel. Sums are binary64, each row's
// in the order of the pixels that they come from, so threads make no difference. What remains of a
// bright stamp behind its end is below 1e-16 of it.
//
// There is no scalar form: Isa::scalar runs the baseline kernels, which need no vector unit.

#include "dof/dof.h"

namespace softfocus {

/// A Method's apply (dof.h), with the aperture of the settings.
void scatter_aperture(const DofInput& input, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus

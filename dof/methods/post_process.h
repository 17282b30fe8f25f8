#pragma once
// Practical post-process depth of field, after Hammon 2007 (GPU Gems 3, ch. 28): a pixel is
// blended from four pictures of fixed sharpness, two of them a quarter of the size.
//
//   quarter   means of 4x4 pixels, and D0, the largest near radius of the 16
//   large     quarter, D0 too, under a Gaussian: D_blur is its near radius
//   medium    quarter under (1 2 1) x (1 2 1) / 16; D, the near radius
//             2 max(D_blur, D0) - D0 under the same, swells over the outline
//   small     (own + 4 (sum of bilinear taps at (.5,-1.5) (-1.5,-.5) (-.5,1.5) (1.5,.5))) / 17
//   r = max(D, the pixel's radius if it lies behind the focus)
//   out = mix(mix(mix(sharp, small, t1), medium, t2), large, t3)
//
// The source blends linearly in r between values to be tuned. Here the blend has the disc's
// second moment: a picture of variance v along an axis stands for a radius of 2 sqrt(v), and
// a mix of two pictures has the mixed variance, so
//   t_i = sat((r^2 - R_(i-1)^2) / (R_i^2 - R_(i-1)^2));   R_0^2 = 1/4
//   R_1^2 = 4 * 24/17;  R_2^2 = 4 (5/4 + 8 + 5/2): 4x4, (1 2 1), enlargement
//   R_3 = max_coc_px: the Gaussian adds what is missing to a variance of R_3^2 / 4
//
// The cost hardly depends on the radius.
//
// Known failures: what is in focus bleeds into the blur behind it, since the blurred pictures
// hold everything; a mix shows sharp and blurred at once, as a fog around near things; a
// point becomes a peak on a mound, and by `small` a pinwheel, which is not symmetric; a near
// thing one pixel wide swells to four.

#include "dof/dof.h"

namespace softfocus {

/// A Method's apply (dof.h).
void post_process(const DofInput& input, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus

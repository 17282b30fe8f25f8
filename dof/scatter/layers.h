#pragma once
// Three layers, near, focus and far, after Scofield 1992 and the account in Real-Time
// Rendering (4th edition, 12.4): the picture is split by depth, each layer is blurred by
// itself as premultiplied colour with its coverage as alpha, and they are composited from
// back to front with "over":
//
//   near: r < -1/2;  focus: |r| <= 1/2, not blurred;  far: r > 1/2    (pixels)
//   L = (blurred colour, blurred coverage a <= 1) of each;  out = near over focus over far,
//   divided by the opacity that is reached
//
// The blur is scatter.h's, each pixel over its own disc: a gather with one radius a layer,
// as in the sources, would blur a floor the same all along. What a layer hides of the one
// behind it is missing there; the division lets its blurred surroundings fill the gap.
//
// Known failures: within a layer nothing hides anything, so a far thing shines over a less
// far one's edge; where a surface passes from one layer to the next, a little of what lies
// behind shows through the seam.

#include "dof/dof.h"

namespace softfocus {

void layers(const DofInput& input, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus

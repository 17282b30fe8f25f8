#pragma once
// From blurred fields at half resolution and the sharp picture to the result.
//
//   far = sum of far w / sum of w, both interpolated bilinearly, w the cells' weight
//   behind = mix(slight, far, t(r) for r >= 0, sat(-r - 2) for r < 0)
//   out = near + (1 - opacity) behind
// t is that of half_fields.h. The weight keeps sharp colours out of what is blurred beside them.
// The highlights' discs (highlights.h) are added.
//
// `slight` is the sharp picture with the blur of circles up to 3/2 pixels, about the pass for
// slight defocus of Abadie 2018: (v/2, 1 - v, v/2) along x and y, v = (r^2 - 1/4) / 4 up to 1/2,
// a disc's variance. A neighbour p comes in by min(1, r_p^2 / r^2) sat(2 - |r_p - r|): not if it
// is sharp, and not if it is of another depth.

#include "dof/half_resolution/half_fields.h"

namespace softfocus {

/// Writes the result. The planes of `fields` are blurred by now, in place: the far colour is
/// times the cell's weight; the near field's four are its blurred colour, premultiplied, and
/// opacity. Without a near field those are not read.
void merge_fields(const DofInput& input, const HalfFields& fields, const ImageView& result,
                  ThreadPool& pool);

}  // namespace softfocus

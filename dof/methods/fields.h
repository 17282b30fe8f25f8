#pragma once
// Near, focus and far fields as three pictures, composited back to front: depth of field "in two
// and a half dimensions" (Akenine-Moller et al. 2018, 12.4).
//
//   near   r < -1/2;   focus  |r| <= 1/2: less than half a pixel of blur;   far  r > 1/2
//   R      a field's radius: sqrt(mean r^2) of its pixels, to a quarter of a pixel
//   n      a pixel's share in its field: min(1, r^2 / R^2); the rest of it stays sharp
//
// Each field is blurred by one disc D of its radius, whatever its depths:
//   far    = D(n c) / D(n): nothing that is sharp or near is in it
//   behind = mix(c, far, n) of far pixels, c in focus; guessed from around where n >= 1/2 of a
//            near pixel (layer_planes.h)
//   near   = D(n c) and its opacity D(n), a picture of its own, soft to both sides of an outline
//   out    = near + (1 - opacity) behind
//
// The share is where fields meet smoothly: without it a floor would be all sharp to a line and
// wholly blurred beyond. It keeps the second moment of a pixel's own circle up to R.
//
// The picture's edges repeat. Sums are binary64, each pixel's in the order of its rows from the
// top; halves of usual pictures add up without rounding. There is no scalar form: Isa::scalar runs
// the baseline kernels, which need no vector unit.
//
// Known failures: one radius a field. What is less blurred than it is a mixture of sharp and too
// blurred, what is more blurred is not blurred enough; a thing that goes from one field to another
// is in two pictures. What a near thing hides is a smooth guess.

#include "dof/dof.h"

namespace softfocus {

/// A Method's apply (dof.h).
void fields(const DofInput& input, const ImageView& result, ThreadPool& pool);

/// R of the near field and of the far one, 0 without pixels.
struct FieldRadii {
  float near_px, far_px;
};
FieldRadii field_radii(const DofInput& input);

}  // namespace softfocus

#pragma once
// Layered, after Lee, Eisemann and Seidel 2009 and Franke et al. 2018: disc-layers that need not
// guess what near things hide, because the layers behind the picture (DofInput::behind) show it.
//
// Behind a pixel P with r_P < -1 lies the first layer that is farther by a step, r > r_P + 1 +
// |r_P| / 4: nearer ones are the same thing's other parts, from which no point of the lens sees
// anything else. It takes the place of disc_hidden.h's guess, which remains where no layer is
// farther by a step. All else is as in disc_layers.h.
//
// Known failures: those of disc-layers but for the guess. What the picture hides beside something
// that is not near, and what lies behind the last layer, is left out. A layer is seen through a
// nearer one by the same share all over its disc: a lens sees more of one side.

#include "dof/dof.h"

namespace softfocus {

/// A Method's apply (dof.h). Without layers behind the picture it is disc_layers().
void layered(const DofInput& input, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus

#pragma once
// Pictures of what a method works from: the circles of confusion and the depth.

#include "dof/lens.h"
#include "raster/images/image.h"

namespace softfocus {

/// The grey map of the thesis: black where sharp, white where the radius reaches
/// `max_coc_px`, linear between; alpha keeps the depth. RGBA16F to RGBA16F.
Image show_coc(const ConstImageView& scene, const PixelCoc& coc, float max_coc_px);

/// Black at `near_m` and nearer, white at `far_m` and farther. Linear in 1 / depth,
/// as circles of confusion are, so that near things keep their steps in a deep scene.
Image show_depth(const ConstImageView& scene, float near_m, float far_m);

}  // namespace softfocus

#pragma once
// Pictures of a method's inputs: the circles of confusion and the depth.

#include "dof/lens.h"
#include "raster/images/image.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// The grey map of the thesis: black where sharp, white where the radius reaches
/// `max_coc_px`, linear between. RGBA16F to RGBA16F; alpha keeps the depth.
Image show_coc(const ConstImageView& scene, const PixelCoc& coc, float max_coc_px,
               ThreadPool& pool);

/// Black at `near_m` and nearer, white at `far_m` and farther. Linear in 1 / depth, as circles
/// of confusion are, so that steps in depth stay visible near the camera in a deep scene.
/// Needs 0 < near_m < far_m.
Image show_depth(const ConstImageView& scene, float near_m, float far_m, ThreadPool& pool);

}  // namespace softfocus

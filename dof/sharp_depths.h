#pragma once
// A field of blur that no lens has: several ranges of depth sharp at once, for methods that
// take radii (dof.h).
//
// Within a range, borders included, the radius is 0. Outside, it is the least of those that the
// lens has there if it is focused at one border of a range or another: so blur begins at each
// border as it does at a lens's focus, and between two ranges it grows and shrinks again
// without a step.

#include <span>
#include <vector>

#include "dof/lens.h"
#include "raster/images/image_view.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// Depths along the axis that are sharp, and the lens focused at either end.
struct SharpDepths {
  PixelCoc at_near;
  PixelCoc at_far;
};

/// The radius in pixels at a depth, 0 or more, at most kLargestMaxCoc. An infinite or NaN depth
/// has the horizon's.
float sharp_depths_radius_px(std::span<const SharpDepths> ranges, float depth_m);

/// The radii of a picture, RGBA16F with depth in alpha, as DofInput::radii_px wants them. Needs
/// a range.
std::vector<float> sharp_depths_radii(const ConstImageView& scene,
                                      std::span<const SharpDepths> ranges, ThreadPool& pool);

}  // namespace softfocus

#pragma once
// How large a picture's circles of confusion are: what a largest radius cuts, and what it would
// have to be to cut nothing.

#include "dof/lens.h"
#include "raster/images/image_view.h"
#include "raster/threads/parallel.h"

namespace softfocus {

struct CircleSizes {
  /// The largest radius in pixels, at most kLargestMaxCoc; 0 if no depth has a circle.
  float largest_px = 0.0f;
  /// The share of pixels, 0 to 1, whose circle is larger than the limit.
  double beyond_limit = 0.0;
};

/// `scene` is RGBA16F, depth in alpha. A NaN depth has no circle; an infinite one has the
/// horizon's.
CircleSizes circle_sizes(const ConstImageView& scene, const PixelCoc& coc, float limit_px,
                         ThreadPool& pool);

}  // namespace softfocus

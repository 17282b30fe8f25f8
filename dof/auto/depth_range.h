#pragma once
// The least and the greatest depth of a picture, of every pixel.

#include <cstdint>

#include "raster/images/image_view.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// Bits of halves, compared as integers: depths from 0 on in order, then infinity, then NaN and
/// negative numbers.
struct DepthRange {
  std::uint16_t least = 0xFFFF;
  std::uint16_t most = 0;
};

/// Of the alpha of an RGBA16F picture.
DepthRange depth_range(const ConstImageView& picture, ThreadPool& pool);

}  // namespace softfocus

#pragma once
// Rows of halves as planes of floats, with their outermost pixels repeated at either end: what
// kernels of this folder read.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "raster/images/image_view.h"
#include "raster/lanes/isa.h"
#include "raster/numbers/half.h"

namespace softfocus {

/// Room for a plane of a row: a pixel more at either end, and a whole vector behind.
inline std::ptrdiff_t plane_floats(int width) { return width + 2 + kMostLanes; }

/// Writes `channels` planes of the row, 2 or 4, plane_floats() apart: pixel 0 to to[1].
void split_texels(const ConstImageView& image, int y, int channels, float* to, Isa isa);

/// Writes four planes, of `width` pixels from planes[0], planes[1] ... on, as RGBA16F. Planes are
/// readable up to a whole vector.
void join_texels(const float* const* planes, int width, HalfRounding rounding, std::uint16_t* to,
                 Isa isa);

}  // namespace softfocus

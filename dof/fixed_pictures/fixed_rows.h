#pragma once
// The fixed-point filter of dof/fixed as it is, row by row, on threads: each takes a strip
// of rows and those above and below that reach it.

#include <span>

#include "dof/fixed/fixed.h"
#include "raster/images/image.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// Filters an RGBA8 or RGBA16F picture into another image of its size and format. Codes lie
/// row by row without gaps; with SOFTFOCUS_FIXED_DEPTH_IN_ALPHA there need be none.
void fixed_two_pass_rows(const ConstImageView& picture, softfocus_fixed_depth depth, const void* codes,
                         std::span<const fixed::Weights> table, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus

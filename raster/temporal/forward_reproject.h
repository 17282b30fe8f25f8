#pragma once
// Forward reprojection: each pixel of the frame before goes to where its surface is now. Of several
// that come to one pixel the nearest stays.

#include <cstdint>

#include "raster/images/image_view.h"
#include "raster/numbers/profile.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// `before` is RGBA16F with its depth in alpha, `velocity` RG16F: how far each of its pixels moves
/// until now. Pixel (x, y) goes to (floor(x + vx + 1/2), floor(y + vy + 1/2)), in binary32. The
/// least depth stays, and of equal ones the first, row by row. A pixel without a depth above 0, and
/// one that leaves the picture, goes nowhere. Where nothing comes is a hole: all zeros. Returns how
/// many there are. All are of one size; the result shares no memory with the others.
///
/// Without atomic operations: each thread owns rows of the result, and reads the spans of pixels
/// that come to them in their order.
std::int64_t forward_reproject(const ConstImageView& before, const ConstImageView& velocity,
                               const ImageView& result, const Profile& profile, ThreadPool& pool);

/// How far fill_holes() looks.
inline constexpr int kHoleReach = 16;

/// A hole, where alpha is 0, becomes the farthest of the nearest pixels that are none to its left,
/// right, above and below it, up to kHoleReach away, the first of equal ones: what a surface
/// uncovers lies behind it. A hole without one stays. Returns how many stay.
std::int64_t fill_holes(const ConstImageView& scattered, const ImageView& result,
                        const Profile& profile, ThreadPool& pool);

}  // namespace softfocus

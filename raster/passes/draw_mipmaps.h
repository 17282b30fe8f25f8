#pragma once
// Mip levels as GPUs' drivers make them: each level is drawn from the one before.

#include "raster/images/texture.h"
#include "raster/numbers/profile.h"

namespace softfocus {

/// Fills in levels 1 and on as glGenerateMipmap of Mesa 22.3 does: for each level a
/// rectangle, a fan of two triangles, over which (0, 0) to (1, 1) run linearly in the
/// window, is drawn with one bilinear fetch a pixel, clamped to the edge, in the
/// profile's arithmetic. Where a side is even the mean of two texels, where it is odd
/// whatever two lie around the pixel's centre.
void draw_mipmaps(Texture& texture, const Profile& profile);

/// The mip levels that a program gets which asks the profile's driver for them: drawn,
/// or those of generate_mipmaps where the texture unit is the standard one.
void generate_mipmaps_as(Texture& texture, const Profile& profile);

}  // namespace softfocus

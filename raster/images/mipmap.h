#pragma once
// Mip levels by the box filter. raster/passes/draw_mipmaps.h has those that drivers draw.

#include "raster/images/texture.h"
#include "raster/numbers/profile.h"

namespace softfocus {

/// Fills in levels 1 and on, each texel the mean of the 2x2 texels (2x, 2y) to
/// (2x + 1, 2y + 1) of the level before as ((a + b) + (c + d)) * 0.25 on decoded
/// values; along a side of length 1 the texel is taken twice, and at the end of an
/// odd side the last one is left out (box filter of GL's reference implementations).
void generate_mipmaps(Texture& texture, const Profile& profile);

}  // namespace softfocus

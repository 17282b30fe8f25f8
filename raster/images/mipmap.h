#pragma once
// Mip levels by the box filter. raster/passes/draw_mipmaps.h draws them as drivers do.

#include "raster/images/texture.h"
#include "raster/numbers/profile.h"

namespace softfocus {

/// Makes levels 1 and up. Each texel is the mean ((a + b) + (c + d)) * 0.25 of decoded texels
/// (2x, 2y) to (2x + 1, 2y + 1) of the level before. Along a side of length 1 the texel counts
/// twice; of an odd side the last texel is left out (box filter of GL's reference
/// implementations).
void generate_mipmaps(Texture& texture, const Profile& profile);

}  // namespace softfocus

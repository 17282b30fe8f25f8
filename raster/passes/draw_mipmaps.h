#pragma once
// Mip levels as drivers make them: each is drawn from the one before.

#include "raster/images/sampler.h"
#include "raster/numbers/profile.h"

namespace softfocus {

/// Makes levels 1 and up as glGenerateMipmap of Mesa 22.3 does. A rectangle is drawn for each
/// level, a fan of two triangles, over which (0, 0) to (1, 1) run linearly in the window. Each
/// pixel is one bilinear fetch, clamped to the edge, in the profile's arithmetic. Along an even
/// side it gives the mean of two texels, along an odd one a mix of the two around the centre.
void draw_mipmaps(Texture& texture, const Profile& profile);

/// The mip levels that the profile's driver makes for a program: drawn, or in the standard
/// texture unit those of generate_mipmaps().
void generate_mipmaps_as(Texture& texture, const Profile& profile);

}  // namespace softfocus

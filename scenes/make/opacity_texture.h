#pragma once
// Opacity from a picture, as `map_d` of materials and `opacity_texture` of scenes name one.

#include "raster/images/sampler.h"

namespace softfocus {

/// Format::rgba8 with all its mipmaps (of the ieee profile); the four channels of a texel are its
/// opacity. That is the picture's alpha if any texel's is below 1, or else the mean of red, green
/// and blue, rounded, as the file has them: a mask is no colour, and is not decoded. Needs a
/// picture of Format::rgba8 or srgb8.
Texture make_opacity_texture(const Image& picture);

/// Whether each texel of level 0 is 0 or 1. Such a surface needs no blending.
bool is_cut_out(const Texture& opacity);

}  // namespace softfocus

#pragma once
// A picture as a browser has it: sRGB codes of 8 bits, opaque, the lowest row first.

#include "raster/images/image.h"

namespace softfocus {

/// Of RGBA16F; or of another format that load_texel() has.
Image codes_of(const ConstImageView& picture);

/// Into RGBA16F: the colours of codes, the depths of `depths`.
void store_codes(const Image& codes, const ConstImageView& depths, const ImageView& result);

}  // namespace softfocus

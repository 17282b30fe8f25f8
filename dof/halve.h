#pragma once
// A picture of half the size, of four pixels each: what was drawn and filtered at twice the size
// gets smooth edges.

#include "raster/images/image.h"
#include "raster/numbers/profile.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// Needs RGBA16F with an even width and height. A pixel's colour is the mean of its four,
/// ((a + b) + (c + d)) * 0.25 with the upper two first, as generate_mipmaps() has it; its depth is
/// the nearest of theirs, for a mean would lie where nothing is.
Image halve(const Image& picture, const Profile& profile, ThreadPool& pool);

}  // namespace softfocus

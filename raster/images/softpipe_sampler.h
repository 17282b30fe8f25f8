#pragma once
// The texture unit of Mesa 22.3's softpipe, bit for bit: all formats in floats, unfused.

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include "raster/images/bilinear.h"
#include "raster/images/sampler.h"

namespace softfocus {

/// sample() as softpipe does it. Coordinates past 2^22 texels read some texel, the same
/// as in the driver.
///
/// Its cache of tiles hands out texels of another tile at some corners of tiles on the
/// seam of a repeating texture, say of 256x256. One thing of that is left out: where the
/// other tile is filled in part, for a side that is no multiple of 32, what is read
/// depends on all fetches before.
glm::vec4 sample_softpipe(const Texture& texture, const Sampler& sampler, glm::vec2 uv, float lod,
                          const Profile& profile);

/// Floor as softpipe takes it, by adding 1.5 * 2^23 and reading the sum's bits: right for
/// |value| <= 2^22 but for negative values above -2^-30, which give 0; what it gives for
/// larger ones is part of the driver. NaN gives 0.
std::int32_t softpipe_floor(float value);

/// The texels that its bilinear filter reads along an axis of `size` texels.
Taps softpipe_taps(float coordinate, int size, Wrap wrap);

/// The texel that a nearest fetch reads.
int softpipe_nearest(float coordinate, int size, Wrap wrap);

}  // namespace softfocus

#pragma once
// The texture unit of Mesa 22.3's softpipe, bit for bit: all formats in floats, unfused.

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include "raster/images/bilinear.h"
#include "raster/images/sampler.h"

namespace softfocus {

/// sample() as softpipe does it. Coordinates past 2^22 texels read the same texel as in the
/// driver.
///
/// softpipe caches tiles. On the seam of a repeating texture, say of 256x256, it reads texels of
/// the wrong tile at some corners of tiles, and so does this. One case is left out: if a side is
/// no multiple of 32, that wrong tile may be filled only in part, and the texel depends on all
/// fetches before.
glm::vec4 sample_softpipe(const Texture& texture, const Sampler& sampler, glm::vec2 uv, float lod,
                          const Profile& profile);

/// Floor as softpipe computes it: adds 1.5 * 2^23 and reads the sum's bits. Right for
/// |value| <= 2^22, except that negative values above -2^-30 give 0. Larger values are wrong as in
/// the driver. NaN gives 0.
std::int32_t softpipe_floor(float value);

/// The texels that its bilinear filter reads along an axis of `size` texels.
Taps softpipe_taps(float coordinate, int size, Wrap wrap);

/// The texel that a nearest fetch reads.
int softpipe_nearest(float coordinate, int size, Wrap wrap);

}  // namespace softfocus

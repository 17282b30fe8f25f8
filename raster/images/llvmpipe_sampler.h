#pragma once
// The texture unit of Mesa 22.3's llvmpipe, bit for bit: its addresses, its float filter
// and its choice of levels. Linear 8-bit textures take unorm8_filter.h instead.

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include "raster/images/bilinear.h"
#include "raster/images/sampler.h"

namespace softfocus {

/// sample() as llvmpipe does it. A coordinate or lod that no 32-bit integer holds goes
/// where x86 converts it to: the lod to level 0.
///
/// Two things are left out. It works on 4 or 8 pixels at a time, and mixes the second
/// level, with weight 0, into pixels that need only one if a neighbour needs two: an
/// infinity or NaN would spread, and -0 become 0. And where it takes the nearest level of a
/// lod of its own, from differences, a lod exactly half-way goes up, not to even.
glm::vec4 sample_llvmpipe(const Texture& texture, const Sampler& sampler, glm::vec2 uv, float lod,
                          const Profile& profile);

/// The texels that llvmpipe's float filter reads along an axis of a level of `size`
/// texels whose level 0 has `base_size`: repeating textures take another path where that
/// is no power of two, which subtracts the whole part of the coordinate first.
Taps llvmpipe_taps(float coordinate, int size, int base_size, Wrap wrap);

/// The texel that a nearest fetch reads.
int llvmpipe_nearest(float coordinate, int size, int base_size, Wrap wrap);

}  // namespace softfocus

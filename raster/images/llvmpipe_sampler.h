#pragma once
// The texture unit of Mesa 22.3's llvmpipe, bit for bit: addresses, the float filter, the choice
// of levels. Linear 8-bit textures have unorm8_filter.h instead.

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include "raster/images/bilinear.h"
#include "raster/images/sampler.h"

namespace softfocus {

/// sample() as llvmpipe does it. Coordinates and lods that no 32-bit integer holds are converted
/// as x86 does; such a lod gives level 0.
///
/// Two things are left out. llvmpipe works on 4 or 8 pixels at a time. If one of them needs two
/// levels, it mixes the second into all, with weight 0: infinities and NaN spread, and -0 becomes
/// 0. And if it finds the lod itself, from differences, the nearest level of a lod half-way
/// between two is the upper one, not the even one.
glm::vec4 sample_llvmpipe(const Texture& texture, const Sampler& sampler, glm::vec2 uv, float lod,
                          const Profile& profile);

/// The texels that the float filter reads along an axis. The level has `size` texels, level 0
/// `base_size`. If that is no power of two, repeating textures take another path, which first
/// subtracts the coordinate's whole part.
Taps llvmpipe_taps(float coordinate, int size, int base_size, Wrap wrap);

/// The texel that a nearest fetch reads.
int llvmpipe_nearest(float coordinate, int size, int base_size, Wrap wrap);

}  // namespace softfocus

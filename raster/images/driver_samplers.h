#pragma once
// The texture unit of Mesa 22.3's llvmpipe, bit for bit: addresses, the float filter, the choice
// of levels. Linear 8-bit textures have integer_filter.h instead.

#include <cstdint>
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

/// The level that a lod reads, and the weight of the next one.
struct LevelChoice {
  std::size_t first;
  float next_weight;
};
LevelChoice llvmpipe_levels(float lod, std::size_t level_count, Filter filter);

/// The texels that the float filter reads along an axis. The level has `size` texels, level 0
/// `base_size`. If that is no power of two, repeating textures take another path, which first
/// subtracts the coordinate's whole part.
Taps llvmpipe_taps(float coordinate, int size, int base_size, Wrap wrap);

/// The texel that a nearest fetch reads.
int llvmpipe_nearest(float coordinate, int size, int base_size, Wrap wrap);

// The texture unit of Mesa 22.3's softpipe, bit for bit: all formats in floats, unfused.

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

// SwiftShader's texture unit, bit for bit: all formats in floats, unfused; bytes as whole numbers,
// which are scaled last. Found in a browser (docs/exactness.md) and in its source,
// src/Pipeline/SamplerCore.cpp.

/// sample() as SwiftShader does it. Trilinear filters always mix two levels: a weight of 0 lets
/// the next level's infinities and NaN through. Its last level is followed by itself.
glm::vec4 sample_swiftshader(const Texture& texture, const Sampler& sampler, glm::vec2 uv,
                             float lod, const Profile& profile);

/// A coordinate brought to 0 <= c < 1. Not a number becomes the largest such float, or 0 if
/// clamped; so do infinities that are not clamped.
float swiftshader_coordinate(float coordinate, Wrap wrap);

/// The texels that a filter reads along an axis of `size` texels.
Taps swiftshader_taps(float coordinate, int size, Wrap wrap);

/// The texel that a nearest fetch of a half or float texture reads.
int swiftshader_nearest(float coordinate, int size, Wrap wrap);

/// The same of a texture of bytes. Its coordinate is cut to 65536ths toward 0, negative ones too,
/// and loses its whole part then. What 2^31 65536ths do not hold is 0.
int swiftshader_nearest_byte(float coordinate, int size, Wrap wrap);

}  // namespace softfocus

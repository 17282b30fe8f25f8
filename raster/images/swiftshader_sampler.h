#pragma once
// SwiftShader's texture unit, bit for bit: all formats in floats, unfused; bytes as whole numbers,
// which are scaled last. Found in a browser (docs/exactness.md) and in its source,
// src/Pipeline/SamplerCore.cpp.

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include "raster/images/bilinear.h"
#include "raster/images/sampler.h"

namespace softfocus {

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

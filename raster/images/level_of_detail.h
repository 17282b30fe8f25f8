#pragma once
// Which mip level a pixel reads: the logarithm of the number of texels it spans.

#include <glm/vec2.hpp>

#include "raster/images/texture.h"
#include "raster/numbers/profile.h"

namespace softfocus {

/// The level of detail of a footprint: differences of (u, v) from one pixel to the next, along
/// x and along y.
///
/// The standard unit and llvmpipe take half of log2_linear of the larger squared length in
/// texels; length 0 gives the most negative lod. softpipe takes log2_by_table of the largest of
/// |du| * width and |dv| * height, with the difference along x from the lower row of the 2x2
/// block of pixels. SwiftShader takes log2_of_root_by_bits of the larger squared length.
float level_of_detail(const Texture& texture, glm::vec2 uv_per_x, glm::vec2 uv_per_y,
                      const Profile& profile);

/// The standard unit's and llvmpipe's.
float level_of_detail(const Texture& texture, glm::vec2 uv_per_x, glm::vec2 uv_per_y);

/// Binary logarithm, straight between powers of two: (e - 1) + m, rounded once, for
/// x = 2^e * m with 1 <= m < 2. Exact at powers of two, up to 0.0861 too small between them. GPUs
/// compute the level so; a shader can do it bit for bit (floatBitsToInt). Subnormals count as
/// e = -127, and 0 gives -127. Needs x >= 0.
float log2_linear(float x);

/// Half of the binary logarithm, as SwiftShader computes it: x * x read as an integer is a
/// logarithm, straight between powers of two, in 2^-23ths. The square makes the line straight
/// between powers of the root of two of x. Up to 0.0215 too small. Needs x >= 0.
float log2_of_root_by_bits(float x);

/// Binary logarithm as softpipe computes it: the exponent plus the logarithm of the mantissa,
/// which is first rounded to a multiple of 1/256, to nearest, ties up. Zero and subnormals have
/// the exponent -127 and an implicit 1. Needs x >= 0.
float log2_by_table(float x);

}  // namespace softfocus

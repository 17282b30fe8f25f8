#pragma once
// Which mip level a pixel reads: the logarithm of how many texels it spans.

#include <glm/vec2.hpp>

#include "raster/images/texture.h"
#include "raster/numbers/profile.h"

namespace softfocus {

/// The level of detail of a footprint: how many texels of level 0 one pixel spans
/// along x and y, as differences of (u, v).
///
/// The standard unit and llvmpipe: half of log2_linear of the larger squared length;
/// a footprint of length 0 has the most negative lod.
/// softpipe: log2_by_table of the largest of |du| * width and |dv| * height. It takes the
/// difference along x from the lower row of the 2x2 block of pixels.
float level_of_detail(const Texture& texture, glm::vec2 uv_per_x, glm::vec2 uv_per_y,
                      const Profile& profile);

/// The standard unit's.
float level_of_detail(const Texture& texture, glm::vec2 uv_per_x, glm::vec2 uv_per_y);

/// Binary logarithm with a straight line between powers of two: of x = 2^e * m, 1 <= m < 2,
/// the sum (e - 1) + m, rounded once. Exact at powers of two, up to 0.0861 too small
/// between them. GPUs compute the level so, and a shader can, bit for bit
/// (floatBitsToInt). Subnormals count as e = -127, and 0 gives -127. Needs x >= 0.
float log2_linear(float x);

/// Binary logarithm as softpipe takes it: the exponent plus the logarithm of the mantissa
/// rounded to a multiple of 1/256, to nearest, ties up. Zero and subnormals count as
/// 2^-127 times 1 and the mantissa's bits. Needs x >= 0.
float log2_by_table(float x);

}  // namespace softfocus

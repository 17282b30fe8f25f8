#pragma once
// Texture sampling as OpenGL 4.6 section 8.14 and D3D11.3 section 7.18 describe it:
// nearest, bilinear and trilinear, with the three wrap modes.

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "raster/images/image.h"
#include "raster/numbers/profile.h"

namespace softfocus {

/// An image and its mip levels, each half the size of the one before, rounded down,
/// to 1x1. Without mipmaps there is one level.
struct Texture {
  std::vector<Image> levels;
};

enum class Wrap : std::uint8_t {
  repeat,
  mirrored_repeat,
  clamp_to_edge,
};

enum class Filter : std::uint8_t {
  nearest,    ///< of the nearest level
  bilinear,   ///< of the nearest level
  trilinear,  ///< bilinear of the two nearest levels, and linear between them
};

struct Sampler {
  Filter filter = Filter::bilinear;
  Wrap wrap_u = Wrap::repeat;
  Wrap wrap_v = Wrap::repeat;
};

/// The texture at (u, v), where (0, 0) is the upper left corner of texel (0, 0) and
/// (1, 1) the lower right one of the last, at level of detail `lod` (0 = full size,
/// clamped to the levels there are; NaN is 0). An infinite or NaN coordinate reads
/// as 0, one past 2^22 texels as 2^22 texels. Needs at least one level.
///
/// Order of operations, in binary32, for a level of width w:
///   u' = u * w - 0.5;  i = floor(u');  t = u' - i
///   with fixed_8 weights u' is first rounded to a multiple of 1/256, ties to even
///   row j:     c_j = lerp(texel(i, j), texel(i + 1, j), t_u)
///   result:    lerp(c_j, c_j+1, t_v)
/// Texels are decoded before they are filtered.
glm::vec4 sample(const Texture& texture, const Sampler& sampler, glm::vec2 uv, float lod,
                 const Profile& profile);

/// The level of detail of a footprint: how many texels of level 0 one pixel spans
/// along x and y, as differences of (u, v). Half of log2_linear of the larger squared
/// length; a footprint of length 0 has the most negative lod.
float level_of_detail(const Texture& texture, glm::vec2 uv_per_x, glm::vec2 uv_per_y);

/// Binary logarithm with a straight line between powers of two, read off the float's
/// bits: exact at powers of two, up to 0.0861 too small between them. GPUs compute
/// the level so, and a shader can, bit for bit (floatBitsToInt). Needs x >= 0.
float log2_linear(float x);

/// Fills in levels 1 and on, each texel the mean of the 2x2 texels (2x, 2y) to
/// (2x + 1, 2y + 1) of the level before as ((a + b) + (c + d)) * 0.25 on decoded
/// values; along a side of length 1 the texel is taken twice, and at the end of an
/// odd side the last one is left out (box filter of GL's reference implementations).
void generate_mipmaps(Texture& texture, const Profile& profile);

/// A texture of one level.
Texture make_texture(Image image);

}  // namespace softfocus

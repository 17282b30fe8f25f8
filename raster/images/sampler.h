#pragma once
// Texture sampling as OpenGL 4.6 section 8.14 and D3D11.3 section 7.18 describe it: nearest,
// bilinear and trilinear, with three wrap modes. Drivers' own ways have files of their own.

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <utility>
#include <vector>

#include "raster/images/image.h"
#include "raster/numbers/profile.h"

namespace softfocus {

// An image with its mip levels, or several.

enum class TextureShape : std::uint8_t {
  flat,
  array,   ///< of layers
  volume,  ///< of slices
  cube,    ///< of six faces: +x, -x, +y, -y, +z, -z
};

/// Each level has half the size of the one before, rounded down, to 1x1. Without mipmaps there
/// is one level. sliced_texture.h has what is not flat.
struct Texture {
  std::vector<Image> levels;
  TextureShape shape = TextureShape::flat;
  /// The layers, slices or faces behind the first, which `levels` is: of its format, sizes and
  /// levels. Level k of a volume of n slices has max(1, n >> k): the slices behind them lack it.
  std::vector<Texture> behind{};
};

/// A texture of one level.
inline Texture make_texture(Image image) {
  Texture texture;
  texture.levels.push_back(std::move(image));
  return texture;
}

// Which mip level a pixel reads: the logarithm of the number of texels it spans.

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

// Mip levels by the box filter. raster/passes/draw_mipmaps.h draws them as drivers do.

/// Makes levels 1 and up. Each texel is the mean ((a + b) + (c + d)) * 0.25 of decoded texels
/// (2x, 2y) to (2x + 1, 2y + 1) of the level before. Along a side of length 1 the texel counts
/// twice; of an odd side the last texel is left out (box filter of GL's reference
/// implementations). Of a volume it is the mean of eight, of two slices.
void generate_mipmaps(Texture& texture, const Profile& profile);

enum class Wrap : std::uint8_t {
  repeat,
  mirrored_repeat,
  clamp_to_edge,
};

enum class Filter : std::uint8_t {
  nearest,    ///< of the nearest level
  bilinear,   ///< of the nearest level
  trilinear,  ///< of the two nearest levels, and linear between them
};

struct Sampler {
  Filter filter = Filter::bilinear;
  Wrap wrap_u = Wrap::repeat;
  Wrap wrap_v = Wrap::repeat;
  Wrap wrap_w = Wrap::repeat;  ///< of a volume
};

/// The texture at (u, v): (0, 0) is the upper left corner of the first texel, (1, 1) the lower
/// right corner of the last. `lod` is the level of detail, 0 for full size, clamped to the levels
/// that there are. Needs at least one level.
///
/// driver_samplers.h describes the drivers' texture
/// units. In the standard
/// one, infinite and NaN coordinates are 0, those past 2^22 texels are 2^22 texels, and a lod of
/// NaN is 0. Order of operations, in binary32, for a level of width w:
///   u' = u * w - 0.5;  i = floor(u');  t = u' - i
///   with fixed_8 weights u' is first rounded to a multiple of 1/256, ties to even
///   row j:     c_j = lerp(texel(i, j), texel(i + 1, j), t_u)
///   result:    lerp(c_j, c_j+1, t_v)
/// Texels are decoded before they are filtered. integer_filter.h has bytes and halves that the
/// profile filters in integers.
glm::vec4 sample(const Texture& texture, const Sampler& sampler, glm::vec2 uv, float lod,
                 const Profile& profile);

}  // namespace softfocus

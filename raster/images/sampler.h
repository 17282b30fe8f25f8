#pragma once
// Texture sampling as OpenGL 4.6 section 8.14 and D3D11.3 section 7.18 describe it: nearest,
// bilinear and trilinear, with three wrap modes. Drivers' own ways have files of their own.

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include "raster/images/level_of_detail.h"
#include "raster/images/mipmap.h"
#include "raster/images/texture.h"
#include "raster/numbers/profile.h"

namespace softfocus {

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
};

/// The texture at (u, v): (0, 0) is the upper left corner of the first texel, (1, 1) the lower
/// right corner of the last. `lod` is the level of detail, 0 for full size, clamped to the levels
/// that there are. Needs at least one level.
///
/// llvmpipe_sampler.h, softpipe_sampler.h and swiftshader_sampler.h describe the drivers' texture
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

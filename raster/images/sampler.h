#pragma once
// Texture sampling as OpenGL 4.6 section 8.14 and D3D11.3 section 7.18 describe it:
// nearest, bilinear and trilinear, with the three wrap modes; and as drivers do it, in
// files of their own.

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
  trilinear,  ///< bilinear of the two nearest levels, and linear between them
};

struct Sampler {
  Filter filter = Filter::bilinear;
  Wrap wrap_u = Wrap::repeat;
  Wrap wrap_v = Wrap::repeat;
};

/// The texture at (u, v), where (0, 0) is the upper left corner of texel (0, 0) and
/// (1, 1) the lower right one of the last, at level of detail `lod` (0 = full size,
/// clamped to the levels there are). Needs at least one level.
///
/// What follows holds for the standard texture unit; llvmpipe_sampler.h and
/// softpipe_sampler.h have the others. An infinite or NaN coordinate reads as 0, one past
/// 2^22 texels as 2^22 texels; a lod of NaN is 0.
///
/// Order of operations, in binary32, for a level of width w:
///   u' = u * w - 0.5;  i = floor(u');  t = u' - i
///   with fixed_8 weights u' is first rounded to a multiple of 1/256, ties to even
///   row j:     c_j = lerp(texel(i, j), texel(i + 1, j), t_u)
///   result:    lerp(c_j, c_j+1, t_v)
/// Texels are decoded before they are filtered.
/// Bytes and halves that the profile filters in integers: see integer_filter.h.
glm::vec4 sample(const Texture& texture, const Sampler& sampler, glm::vec2 uv, float lod,
                 const Profile& profile);

}  // namespace softfocus

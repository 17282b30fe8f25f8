#pragma once
// Integer filters of drivers.

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "raster/images/image.h"
#include "raster/images/integer_bilinear.h"
#include "raster/images/sampler.h"
#include "raster/numbers/profile.h"

namespace softfocus {

// llvmpipe's filter in 8-bit integers, with 8-bit weights, for linear 8-bit textures that repeat
// or clamp. The result becomes floats at the end.

/// Whether llvmpipe filters this format with this sampler in integers.
bool is_filtered_in_integers(Format format, const Sampler& sampler);

/// A bilinear fetch from level `level`, mixed with the next level by `next_weight`: 0 <= weight
/// < 1, cut to 8 bits; 0 reads one level. Values are rounded to 8 bits after each row, between
/// rows, between a volume's slices and between levels, and scaled by 1/255 at the end. `at`: u, v,
/// and w of a volume.
glm::vec4 sample_slices_unorm8(const Texture& texture, const Sampler& sampler, glm::vec3 at,
                               std::size_t level, float next_weight);
inline glm::vec4 sample_unorm8(const Texture& texture, const Sampler& sampler, glm::vec2 uv,
                               std::size_t level, float next_weight) {
  return sample_slices_unorm8(texture, sampler, {uv.x, uv.y, 0.0f}, level, next_weight);
}

// The standard texture unit's integer filter, for linear bytes and halves: 8-bit weights, exact
// sums (integer_bilinear.h), one rounding.

/// Whether textures of this format are filtered in integers. sRGB bytes are not, as they are
/// decoded first; nor are texels of 32 bits.
bool has_integer_filter(Format format, const Profile& profile);

/// Where a bilinear fetch reads; `level` of r8, rgba8 or rgba16f.
struct IntegerFetch {
  const Image* level;
  IntegerTaps u, v;
};

/// fine + next_weight / 256 (coarse - fine), next_weight 0 to 256; with 0 `coarse` is not read.
///
/// Bytes: the sum in 2^-24 of 255 is exact in 32 bits, is rounded to binary32 (a single level
/// needs no rounding) and divided by 255 2^24. So four equal texels give the same as a nearest
/// fetch. Halves: the sum in 2^-48 is exact and rounded once to binary32. If any half that is
/// read is infinite or NaN, whatever it weighs, its channel is filtered in floats with the
/// profile's lerp.
glm::vec4 filter_in_integers(const IntegerFetch& fine, const IntegerFetch& coarse, int next_weight,
                             const Profile& profile);

}  // namespace softfocus

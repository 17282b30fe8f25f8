#pragma once
// llvmpipe's filter in 8-bit integers, with 8-bit weights, for linear 8-bit textures that repeat
// or clamp. The result becomes floats at the end.

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include "raster/images/image.h"
#include "raster/images/integer_bilinear.h"
#include "raster/images/sampler.h"

namespace softfocus {

/// Whether llvmpipe filters this format with this sampler in integers.
bool is_filtered_in_integers(Format format, const Sampler& sampler);

/// A bilinear fetch from level `level`, mixed with the next level by `next_weight`: 0 <= weight
/// < 1, cut to 8 bits; 0 reads one level. Values are rounded to 8 bits after each row, between
/// rows and between levels, and scaled by 1/255 at the end.
glm::vec4 sample_unorm8(const Texture& texture, const Sampler& sampler, glm::vec2 uv,
                        std::size_t level, float next_weight);

}  // namespace softfocus

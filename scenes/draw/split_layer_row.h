#pragma once
// A row of a transparent layer as it was drawn, made into colour and opacity, each with depth.

#include <cstdint>

#include "raster/lanes/isa.h"
#include "raster/numbers/half.h"

namespace softfocus {

/// From depths in the buffer to metres: 1 / (1/far + (1 - d) (1/near - 1/far)) in binary32. 1 - d
/// loses nothing where most depths lie, from 1/2 on.
struct DepthsInMetres {
  float inverse_far, inverse_near_less_far;
};

/// RGBA16F: colour times opacity, and opacity in alpha; and depths of the buffer.
struct DrawnLayerRow {
  const std::uint16_t* texels;
  const float* depths;
  int width;
};

/// Writes the colour to `colour`, the opacity to red, green and blue of `opacity`, both RGBA16F,
/// and to the alpha of both the depth in metres, rounded to a half; where the opacity is 0, the
/// alpha of `elsewhere`.
void split_layer_row(const DrawnLayerRow& row, const DepthsInMetres& in_metres,
                     HalfRounding rounding, const std::uint16_t* elsewhere, std::uint16_t* colour,
                     std::uint16_t* opacity, Isa isa);

}  // namespace softfocus

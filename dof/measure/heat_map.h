#pragma once
// A map of errors as a picture: black over purple, red and orange to a pale yellow.

#include <array>

#include "dof/measure/difference.h"
#include "raster/images/image.h"

namespace softfocus {

/// Red, green and blue of a value, 0 to 1, sRGB-encoded. Values are clamped to 0..1; NaN is 0.
/// Luminance rises with the value, so that the map reads in grey too.
std::array<double, 3> heat_colour(double value);

/// RGBA16F, linear light, alpha 1.
Image heat_picture(const PixelMap& map);

}  // namespace softfocus

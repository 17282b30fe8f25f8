#pragma once
// A map of errors as a picture: black over purple, red and orange to a pale yellow.

#include <array>

#include "dof/measure/pixel_map.h"
#include "raster/images/image.h"

namespace softfocus {

/// Red, green and blue, 0 to 1, sRGB-encoded, of a value; outside of 0 to 1 as the nearer end,
/// NaN as 0. Black for 0 alone; luminance rises all the way, so that it reads in grey too.
std::array<double, 3> heat_colour(double value);

/// RGBA16F, linear light, alpha 1.
Image heat_picture(const PixelMap& map);

}  // namespace softfocus

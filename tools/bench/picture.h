#pragma once
// A picture to filter without drawing one: it has every circle of confusion, and silhouettes.

#include "raster/images/image.h"

namespace softfocus {

/// The focus distance that the picture is made for.
inline constexpr double kBenchPictureFocusM = 2.0;

/// The circle at infinity of the lens that it is made for, over the filter's largest.
inline constexpr double kBenchPictureHorizon = 1.5;

/// RGBA16F, depth in metres in alpha. A floor goes from the horizon above to half its blur in front
/// of the focus below, and 48 discs of all depths stand before it. With the lens above the signed
/// radii go from -1.2 to 1.2 times the filter's largest. Colours are smooth waves and noise, from 0
/// to 1.2. Every machine gives the same bits.
Image bench_picture(int width, int height);

}  // namespace softfocus

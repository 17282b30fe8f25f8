#pragma once
// The worst place of a map of errors, and parts of pictures to look at.

#include "dof/measure/difference.h"
#include "raster/images/image.h"

namespace softfocus {

/// A square part of a picture.
struct Crop {
  int x = 0;
  int y = 0;
  int side = 0;
};

/// The square with the largest sum of values; of equal ones the first in reading order. `side`
/// is at most the map's width and height.
Crop worst_crop(const PixelMap& map, int side);

/// That part of an RGBA16F picture, to the bit.
Image cropped(const Image& picture, const Crop& crop);
PixelMap cropped(const PixelMap& map, const Crop& crop);

/// RGBA16F, smaller by a whole factor: means of `factor` x `factor` pixels in linear light,
/// clamped to 0..1. Blocks at the right and lower border may have fewer pixels.
Image reduced(const Image& picture, int factor);
PixelMap reduced(const PixelMap& map, int factor);

/// The least factor that brings both sides to `longest_side` or less.
int reduction_factor(int width, int height, int longest_side);

}  // namespace softfocus

#pragma once
// Pictures of a trial that are small enough for a page with hundreds: PNG in base64.

#include <string>

#include "raster/images/image.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// By which pictures are brightened: brings a dark truth's brightest light to 0.8, and leaves
/// others as they are.
double display_gain(const Image& truth);

/// Brightened and reduced.
std::string stress_picture(const Image& picture, double gain);

/// The map of FLIP between two brightened pictures, as colours.
std::string stress_error_picture(const Image& truth, const Image& result, double gain,
                                 ThreadPool& pool);

}  // namespace softfocus

#pragma once
// Mean squared error and the peak signal-to-noise ratio that follows from it.

#include "dof/measure/pixel_map.h"
#include "dof/measure/tone.h"
#include "raster/images/image.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// For each pixel the mean over red, green and blue of the squared difference of toned
/// values; its mean over pixels is the MSE. Both RGBA16F and of one size.
PixelMap squared_error_map(const Image& a, const Image& b, const ToneTable& tone, ThreadPool& pool);

/// Peak signal-to-noise ratio in decibels for a peak of 1: -10 log10(mse). Infinite for 0, NaN
/// for NaN.
double psnr_db(double mean_squared_error);

}  // namespace softfocus

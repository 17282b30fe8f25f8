#pragma once
// Structural similarity: mean, contrast and structure of two pictures, compared in a
// window around each pixel.
//
// Source: Wang, Bovik, Sheikh and Simoncelli, "Image Quality Assessment: From Error
// Visibility to Structural Similarity" (2004), eq. 13:
//
//   SSIM = (2 ma mb + C1) (2 sab + C2) / ((ma^2 + mb^2 + C1) (sa^2 + sb^2 + C2))
//
// m being means, s variances and the covariance under a Gaussian of sigma 1.5 in a window
// of 11x11 pixels; C1 = 0.01^2 and C2 = 0.03^2 for values of 0 to 1. Taken on luma. The
// borders' pixels are repeated beyond them, where the paper leaves the border out, so that
// every pixel has its value.

#include "dof/measure/pixel_map.h"
#include "dof/measure/tone.h"
#include "raster/images/image.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// SSIM of each pixel, -1 to 1, 1 where the windows are equal; the picture's is the mean.
/// Both RGBA16F and of one size; `tone` had best be encoded, as luma is.
PixelMap ssim_map(const Image& a, const Image& b, const ToneTable& tone, ThreadPool& pool);

}  // namespace softfocus

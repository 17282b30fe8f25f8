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

#include <functional>
#include <span>
#include <vector>

#include "dof/measure/difference.h"
#include "dof/measure/tone.h"
#include "raster/images/image.h"
#include "raster/threads/parallel.h"

namespace softfocus {

// Filters in two passes, along rows and along columns, on strips of a picture: a strip with its
// margins stays in a core's cache.

/// Weights of the offsets -radius() to radius().
struct FilterTaps {
  std::vector<double> weights;  ///< an odd number of them
  int radius() const { return static_cast<int>(weights.size() / 2); }
};

/// exp(-x^2 / (2 sigma^2)), summing to 1.
FilterTaps gaussian_taps(double sigma_px, int radius);

/// Where a strip lies, and how far the filter reads past it on all sides.
struct RowStrip {
  int first_row;
  int rows;
  int margin;
};

/// Cuts a picture into strips and runs `body` for each, on any thread.
void for_each_strip(int height, int margin, ThreadPool& pool,
                    const std::function<void(const RowStrip&)>& body);

/// An empty map for a strip with its margins.
PixelMap strip_map(int width, const RowStrip& strip);

/// Row `strip_row` of a strip's map, 0 being the top one of the margin, as the row of the
/// picture it shows: beyond the border, the border's.
int picture_row(const RowStrip& strip, int strip_row, int picture_height);

/// The part of a strip map's row that lies in the picture.
std::span<double> between_margins(PixelMap& map, const RowStrip& strip, int strip_row);

/// Repeats the first and last value of each row in the left and right margin.
void fill_margins(PixelMap& map, const RowStrip& strip);

/// A strip's map filtered along its rows, without the left and right margin.
PixelMap filtered_along(const PixelMap& map, const RowStrip& strip, const FilterTaps& taps);

/// That map filtered along its columns, without the margin above and below.
PixelMap filtered_down(const PixelMap& map, const RowStrip& strip, const FilterTaps& taps);

/// SSIM of each pixel, -1 to 1, 1 where the windows are equal; the picture's is the mean.
/// Both RGBA16F and of one size; `tone` had best be encoded, as luma is.
PixelMap ssim_map(const Image& a, const Image& b, const ToneTable& tone, ThreadPool& pool);

}  // namespace softfocus

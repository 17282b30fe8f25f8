#pragma once
// Small measures of the atlas, beside those of dof/measure.

#include <span>
#include <vector>

#include "raster/images/image.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// The part of a disc of radius 1 to the left of x, -1 to 1: 1 - E(x) is the edge-spread function
/// of a lens. 0 for x below -1, 1 above 1.
double disc_left_of(double x);

/// The luminance of a pixel; NaN and infinity stay so, for they are faults here.
double light_at(const Image& picture, int x, int y);

/// Rows or columns from `begin` to `end` - 1.
struct PixelRange {
  int begin = 0;
  int end = 0;
};

/// The mean light of each column, over some rows.
std::vector<double> column_means(const Image& picture, PixelRange rows);

/// The middle half of so many rows, away from the border.
inline PixelRange middle_half(int size) { return {size / 4, size - size / 4}; }

/// The root of the mean square of a - b over a range.
double rms_difference(std::span<const double> a, std::span<const double> b, PixelRange range);

/// The largest |a - b| over a range, 0 if it is empty. NaN if one of them is NaN.
double largest_difference(std::span<const double> a, std::span<const double> b, PixelRange range);

/// The part of the cosine of that period, with a crest at the picture's left border, in each row
/// between two columns: its amplitude, with its sign. The range is whole periods.
std::vector<double> wave_amplitudes(const Image& picture, double period_px, PixelRange columns);

/// The standard deviation over the mean of the light of pixels that lie wholly within a disc; 0
/// where fewer than 5 do.
double unevenness(const Image& picture, double centre_x_px, double centre_y_px, double radius_px);

/// Pixels with a colour that is NaN or infinite.
int spoilt_pixels(const Image& picture);

/// Mean FLIP, and HDR-FLIP, of a picture against the truth. Infinity if a pixel is spoilt.
double answer_flip(const Image& truth, const Image& result, ThreadPool& pool);
double answer_hdr_flip(const Image& truth, const Image& result, ThreadPool& pool);

/// The mean of |change - true change| over the mean of |true change|, sRGB-encoded: flicker() in
/// units of the change that there should be.
double false_change(std::span<const Image> truth, std::span<const Image> result);

/// The light of a disc of `radius_px` about (x, y), summing to 1, at a pixel.
double disc_light(int x, int y, double centre_x_px, double centre_y_px, double radius_px);

/// The light of a square of bright pixels, each blurred: sums to side^2.
double square_light(int x, int y, int left, int top, int side, double radius_px);

}  // namespace softfocus

#pragma once
// Filters in two passes, along rows and along columns, on strips of a picture: a strip with its
// margins stays in a core's cache.

#include <functional>
#include <span>
#include <vector>

#include "dof/measure/pixel_map.h"
#include "raster/threads/parallel.h"

namespace softfocus {

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

}  // namespace softfocus

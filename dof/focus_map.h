#pragma once
// How blurred a picture is, and where. It tells a filter how far its taps must go, and which
// parts need no filter at all.

#include <vector>

#include "dof/dof.h"

namespace softfocus {

/// The largest filter_radius() in a picture: taps farther away weigh 0.
float largest_filter_radius(const DofInput& input, ThreadPool& pool);

inline constexpr int kCellWidth = 32;
inline constexpr int kCellHeight = 16;

/// A bound of the radii in each cell of kCellWidth x kCellHeight pixels.
struct FocusMap {
  int columns;  ///< of cells
  int rows;
  std::vector<float> largest_px;  ///< row by row; at least the largest filter_radius()
};

inline float largest_px(const FocusMap& map, int column, int row) {
  return map.largest_px[static_cast<std::size_t>(row * map.columns + column)];
}

/// Whether a result is better written past the caches: if it is larger than they are, it
/// leaves them before anything reads it, and a line that is not cached is first read from
/// memory to be overwritten. Its rows must begin on cache lines.
bool write_past_caches(const ConstImageView& result);

/// Makes the map, and writes the cells of `result` in which no radius is above 1, as if no
/// neighbour reached them: a gather of one pixel is (c * 1) / 1. Needs a unit with kernels.
FocusMap pass_in_focus(const DofInput& input, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus

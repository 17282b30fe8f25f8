#pragma once
// How blurred a picture is where: a bound of the radii in each of its cells. It tells a
// filter how far its taps must go, and where it has nothing to do.

#include <vector>

#include "dof/dof.h"

namespace softfocus {

inline constexpr int kCellWidth = 32;
inline constexpr int kCellHeight = 16;

struct FocusMap {
  int columns;  ///< of cells
  int rows;
  /// At least each pixel's filter_radius(), row by row, and hardly more.
  std::vector<float> largest_px;
};

inline float largest_px(const FocusMap& map, int column, int row) {
  return map.largest_px[static_cast<std::size_t>(row * map.columns + column)];
}

/// Whether a result is better written past the caches: one that is larger than they are
/// would leave them before anything reads it, and each line of it would first be read
/// from memory to be overwritten.
bool write_past_caches(const ConstImageView& result);

/// Makes the map, and gives the cells of `result` that lie in focus, with no radius
/// above 1, what they are if no neighbour reaches them: a gather of one pixel is
/// (c * 1) / 1. Needs a unit with kernels.
FocusMap pass_in_focus(const DofInput& input, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus

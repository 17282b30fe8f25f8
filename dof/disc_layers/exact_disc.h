#pragma once
// Discs of any radius, by the cover of each pixel.

#include <cstddef>
#include <vector>

namespace softfocus {

/// A disc of a radius, by the exact cover of each pixel, and the same in all four quarters.
struct ExactDisc {
  /// The row at |dy|: pixels up to |dx| = whole are covered wholly, up to `outer` in part.
  struct Row {
    int whole, outer;   ///< whole is -1 if there are none
    std::size_t cover;  ///< in `covers`: of |dx| = whole + 1, ..., outer
  };
  std::vector<Row> rows;  ///< |dy| = 0, 1, ...
  std::vector<double> covers;
  double area = 0.0;  ///< the sum over all pixels
};
ExactDisc exact_disc(double radius_px);

}  // namespace softfocus

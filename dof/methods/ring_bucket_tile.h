#pragma once
// What ring_bucket.cpp hands to its kernels.

#include <cstddef>

namespace softfocus {

struct BucketTap {
  int dx, dy;
  float distance_px;
};

/// A row of a tile and its neighbours, in half-resolution pixels.
struct BucketRow {
  /// Red, green, blue, size, 1 / size^2 and share in the near field at the row's first pixel, of
  /// rows `dy` away at rows[dy]; planes are `plane` apart. Taps to either side need no test.
  const float* const* rows;
  std::ptrdiff_t plane;
  int count;

  const BucketTap* taps;  ///< from the outermost ring in
  int rings;
  float spacing_px;
  float inverse_density;  ///< 1 / D
  float gain;
  bool near_field;  ///< whether any share in it is more than 0

  /// Background colour, near colour, near opacity: planes `result_plane` apart.
  float* result;
  std::ptrdiff_t result_plane;
};

}  // namespace softfocus

#pragma once
// What post_process.cpp hands to its kernels.

#include <cstddef>

namespace softfocus {

/// Rows of full resolution that are blended.
struct PostProcessRow {
  /// Red of rows -2 to 2 from the one to be blended, with two pixels more at either end.
  const float* sharp[5];
  std::ptrdiff_t sharp_plane;
  const float* radius;
  /// Enlarged: medium's red, green, blue, near radius, large's red, green, blue.
  const float* blurred;
  std::ptrdiff_t blurred_plane;
  int count;
  float squares[4];   ///< R_i^2
  float inverses[4];  ///< 1 / (R_i^2 - R_(i-1)^2), from 1 on
  float* result;
  std::ptrdiff_t result_plane;
};

}  // namespace softfocus

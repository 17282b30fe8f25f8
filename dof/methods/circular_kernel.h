#pragma once
// What circular_separable.cpp hands to its kernels.

#include <cstddef>

namespace softfocus {

struct CircularComponent {
  float real_factor;       ///< A
  float imaginary_factor;  ///< B
  const float* real;       ///< k(1) by radius in sixteenths of a pixel
  const float* imaginary;
};

/// A row of receivers and what lies around them.
struct CircularRow {
  /// taps[d] is the first receiver's neighbour at distance d to one side or, negative, the
  /// other, in the first plane; there are taps up to `reach`. Planes are values, then the
  /// radius.
  const float* const* taps;
  std::ptrdiff_t plane;
  int reach;
  int count;  ///< of receivers

  CircularComponent components[2];
  float* result;
  std::ptrdiff_t result_plane;
};

/// Of the radius: where the cut's middle lies.
inline constexpr float kCircularCut[] = {1.2f / 1.085f, 1.2f / 1.11f};

}  // namespace softfocus

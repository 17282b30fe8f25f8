#pragma once
// The filters of FLIP, each a pass along rows and a pass along columns.

#include "dof/measure/separable.h"

namespace softfocus {

struct FlipFilters {
  /// Contrast sensitivity of the opponent channels (table 1 of the paper):
  /// a sqrt(pi / b) exp(-pi^2 d^2 / b) at d degrees, b = 0.0047 for light and dark, 0.0053
  /// for red and green, and for blue and yellow two terms, a = 34.1 with b = 0.04 and
  /// a = 13.5 with b = 0.025. Each sums to 1.
  FilterTaps achromatic;
  FilterTaps red_green;
  FilterTaps blue_yellow_wide;
  FilterTaps blue_yellow_narrow;
  double wide_share;  ///< of the two terms' sum in two dimensions; the rest is narrow

  /// Features, along the derivative and across it. Positive weights sum to 1, negative
  /// ones to -1; `smooth` sums to 1.
  FilterTaps edge;
  FilterTaps point;
  FilterTaps smooth;

  int margin;  ///< the largest radius
};

/// `pixels_per_degree` > 0.
FlipFilters flip_filters(double pixels_per_degree);

}  // namespace softfocus

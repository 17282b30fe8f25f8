#pragma once
// The contenders that no other beats in both of two costs, and what follows from the times of a
// scene's contenders.

#include <span>
#include <vector>

#include "tools/chart/point.h"

namespace softfocus {

struct TwoCosts {
  double time = 0.0;
  double error = 0.0;
};

/// The indices of the contenders on the front, from the fastest on, so that errors fall. A
/// contender is off the front if another is better in one cost and no worse in the other. Equal
/// ones are all on it, those with a NaN never.
std::vector<std::size_t> pareto_front(std::span<const TwoCosts> contenders);

/// Fills in the medians, the points on the scene's front of time against FLIP, and each series'
/// best setting. The front is that of the fixed methods; a point of auto is on it unless a fixed
/// one with at most its FLIP is a tenth faster. Points without times are on no front.
void settle_points(ChartPanel& panel);

/// Whether all points have times; none have where --rounds is 0.
bool has_times(const ChartPanel& panel);

}  // namespace softfocus

#pragma once
// The contenders that no other beats in both of two costs.

#include <span>
#include <vector>

namespace softfocus {

struct TwoCosts {
  double time = 0.0;
  double error = 0.0;
};

/// The indices of the contenders on the front, from the fastest on, so that errors fall. A
/// contender is off the front if another is better in one cost and no worse in the other. Equal
/// ones are all on it, those with a NaN never.
std::vector<std::size_t> pareto_front(std::span<const TwoCosts> contenders);

}  // namespace softfocus

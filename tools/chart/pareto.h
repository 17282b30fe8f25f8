#pragma once
// Which of several contenders no other beats in both of two costs.

#include <span>
#include <vector>

namespace softfocus {

struct TwoCosts {
  double time = 0.0;
  double error = 0.0;
};

/// The indices of those for which nothing is at most as slow and at most as wrong, and less
/// in one of the two; from the fastest on, so that errors fall. Of equal ones all. What has a
/// NaN is never among them.
std::vector<std::size_t> pareto_front(std::span<const TwoCosts> contenders);

}  // namespace softfocus

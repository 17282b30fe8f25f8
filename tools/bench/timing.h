#pragma once
// Statistics of times: of one thing timed often, and of two things timed in turn.

#include <span>
#include <vector>

namespace softfocus {

/// The middle and the ends of some samples.
struct Spread {
  double median = 0.0;
  double min = 0.0;
  double max = 0.0;
};

/// Needs at least one sample. The median of an even number is the mean of the two in the middle.
Spread spread_of(std::vector<double> samples);

/// peer / ours, pair by pair: how many times faster ours was. Needs two lists of one length, all
/// values above 0.
std::vector<double> pair_ratios(std::span<const double> ours, std::span<const double> peers);

}  // namespace softfocus

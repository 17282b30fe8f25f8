#include "tools/bench/timing.h"

#include <algorithm>
#include <cassert>

namespace softfocus {

Spread spread_of(std::vector<double> samples) {
  assert(!samples.empty());
  std::sort(samples.begin(), samples.end());
  const std::size_t half = samples.size() / 2;
  const double median =
      samples.size() % 2 == 1 ? samples[half] : (samples[half - 1] + samples[half]) / 2.0;
  return {median, samples.front(), samples.back()};
}

std::vector<double> pair_ratios(std::span<const double> ours, std::span<const double> peers) {
  assert(ours.size() == peers.size());
  std::vector<double> ratios;
  for (std::size_t i = 0; i < ours.size(); ++i) ratios.push_back(peers[i] / ours[i]);
  return ratios;
}

}  // namespace softfocus

#include "tools/bench/paired_runs.h"

#include <algorithm>
#include <chrono>

namespace softfocus {
namespace {

using Clock = std::chrono::steady_clock;

// At least 1 ns, the unit of the clock: a ratio needs something to divide by.
double ms_since(Clock::time_point start) {
  const std::chrono::duration<double, std::milli> elapsed = Clock::now() - start;
  return std::max(elapsed.count(), 1e-6);
}

std::vector<StageSamples> no_samples(const std::vector<TimedStage>& stages) {
  std::vector<StageSamples> samples;
  samples.reserve(stages.size());
  for (const TimedStage& stage : stages) samples.push_back({stage.name, {}});
  return samples;
}

// The first stage is run once more before it counts: the other contender has filled the
// caches with its own, and its threads may not have come to rest.
void time_once(const std::vector<TimedStage>& stages, std::vector<StageSamples>& samples) {
  if (!stages.empty()) stages.front().work();
  for (std::size_t i = 0; i < stages.size(); ++i) {
    const Clock::time_point start = Clock::now();
    stages[i].work();
    samples[i].ms.push_back(ms_since(start));
  }
}

}  // namespace

void warm_up(const std::vector<TimedStage>& stages) {
  constexpr int kLeastRounds = 2;
  constexpr double kLeastMs = 200.0;
  const Clock::time_point start = Clock::now();
  for (int round = 0; round < kLeastRounds || ms_since(start) < kLeastMs; ++round) {
    for (const TimedStage& stage : stages) stage.work();
  }
}

PairedSamples time_in_pairs(const std::vector<TimedStage>& ours,
                            const std::vector<TimedStage>& peers, int pairs,
                            const std::function<void(int)>& on_run) {
  PairedSamples samples{no_samples(ours), no_samples(peers)};
  for (int pair = 0; pair < pairs; ++pair) {
    on_run(pair);
    const bool ours_first = pair % 2 == 0;
    if (ours_first) time_once(ours, samples.ours);
    time_once(peers, samples.peers);
    if (!ours_first) time_once(ours, samples.ours);
  }
  return samples;
}

}  // namespace softfocus

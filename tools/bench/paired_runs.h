#pragma once
// Two contenders timed in turn, so that what disturbs the machine disturbs both.

#include <functional>
#include <string>
#include <vector>

namespace softfocus {

/// A part of a frame's work that is timed by itself.
struct TimedStage {
  std::string name;
  std::function<void()> work;
};

/// A stage's times in milliseconds, run by run.
struct StageSamples {
  std::string name;
  std::vector<double> ms;
};

/// Runs all stages in order, at least twice and for at least 200 ms.
void warm_up(const std::vector<TimedStage>& stages);

struct PairedSamples {
  std::vector<StageSamples> ours;
  std::vector<StageSamples> peers;
};

/// Times our stages and then the peer's; in the next pair the peer's come first, and so on. A
/// contender's first stage runs once without a clock before it counts. If the peer has no stages,
/// ours are timed alone. Calls `on_run` with each pair's number, from 0, before the pair begins.
PairedSamples time_in_pairs(const std::vector<TimedStage>& ours,
                            const std::vector<TimedStage>& peers, int pairs,
                            const std::function<void(int)>& on_run);

}  // namespace softfocus

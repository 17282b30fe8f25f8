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

/// Times every stage of ours and then every stage of the peer's, in the next pair the peer
/// first, and so on; before, the contender's first stage once without a clock. Without stages of
/// the peer's ours are timed alone. `on_run` is told each pair's number, from 0, before it begins.
PairedSamples time_in_pairs(const std::vector<TimedStage>& ours,
                            const std::vector<TimedStage>& peers, int pairs,
                            const std::function<void(int)>& on_run);

}  // namespace softfocus

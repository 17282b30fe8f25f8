#pragma once
// The sums of `softfocus relief turn`: times, errors and lateness.

#include <cstddef>
#include <vector>

#include "scenes/relief/impostors/impostor_schedule.h"
#include "tools/relief/turn_frames.h"

namespace softfocus {

struct TurnSums {
  std::vector<double> redrawn_ms, impostor_ms, renew_ms, recall_ms, warp_ms, sprite_ms;
  TurnErrors errors;
  std::vector<double> predicted, bound;  ///< divided by the largest error
  std::size_t most_bytes = 0;
  int renewals = 0, updates = 0, stalls = 0, stale = 0;
  std::vector<double> late_frames;
};

/// Adds a frame's time and what was done in it.
void add_frame(const ScheduledFrame& frame, double ms, TurnSums& sums);

void print_sums(const Scene& scene, const ReliefOptions& options, const TurnSums& sums);

}  // namespace softfocus

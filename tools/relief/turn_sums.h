#pragma once
// What `softfocus relief turn` measures: times, errors of the measured frames, and lateness.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "raster/images/image.h"
#include "raster/threads/parallel.h"
#include "scenes/relief/impostor_schedule.h"
#include "tools/relief/relief_options.h"

namespace softfocus {

struct TurnSums {
  std::vector<double> redrawn_ms, impostor_ms, renew_ms, recall_ms, warp_ms, sprite_ms;
  std::vector<double> flip, object_flip, outline_px;
  double most_outline_px = 0.0;
  std::size_t lost = 0, gained = 0, seen = 0;  ///< pixels, of measured frames
  std::vector<double> predicted, bound;        ///< times the measured error
  std::size_t most_bytes = 0;
  int renewals = 0, updates = 0, stalls = 0, stale = 0;
  std::vector<double> late_frames;
};

double mean_of(const std::vector<double>& values);

/// The value that `share` of all are below: 0 the least, 1 the largest; 0 of none.
double sorted_at(std::vector<double> values, double share);

/// Adds a frame's time and what was done in it.
void add_frame(const ScheduledFrame& frame, double ms, TurnSums& sums);

/// Compares a frame with the one that was redrawn. `background_depth` is a half.
void measure_frame(const Image& redrawn, const Image& shown, std::uint16_t background_depth,
                   ThreadPool& pool, TurnSums& sums);

void print_sums(const Scene& scene, const ReliefOptions& options, const TurnSums& sums);

}  // namespace softfocus

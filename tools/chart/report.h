#pragma once
// The chart as numbers: CSV and JSON.

#include <string>
#include <vector>

#include "tools/chart/point.h"
#include "tools/files/json.h"

namespace softfocus {

/// Fills in the medians, and marks the points on the scene's front of time against FLIP. The front
/// is that of the fixed methods; a point of auto is on it unless a fixed one with at most its FLIP
/// is a tenth faster. Needs a time for each point.
void settle_points(ChartPanel& panel);

/// A list of {scene, method, settings, median_ms, psnr_db, ssim, flip, flip_silhouette,
/// flip_near, flip_focus, flip_far, filter_ms, rounds, on_front, truth_samples, noise_floor_flip,
/// noise_floor_psnr_db, picture_hash}. null: an infinite PSNR, a region without pixels, the
/// filter's share where nothing is filtered.
Json chart_json(const std::vector<ChartPanel>& panels);

/// The same list as lines under a line of names (RFC 4180, but lines end in LF). Settings are
/// "max_coc_px=16;profile=ieee"; null is empty.
std::string chart_csv(const std::vector<ChartPanel>& panels);

}  // namespace softfocus

#pragma once
// The chart as numbers: CSV and JSON.

#include <string>
#include <vector>

#include "tools/chart/point.h"
#include "tools/files/json.h"

namespace softfocus {

/// Fills in the medians, and which points are on each scene's front of time against FLIP: of
/// the fixed methods, and those of auto that no fixed one is as near and a tenth faster than.
/// Needs a time for each point.
void settle_points(ChartPanel& panel);

/// A list of {scene, method, settings, median_ms, psnr_db, ssim, flip, flip_silhouette,
/// flip_near, flip_focus, flip_far, filter_ms, rounds, on_front, truth_samples, noise_floor_flip,
/// noise_floor_psnr_db, picture_hash}. null: an infinite PSNR, a region without pixels, the
/// filter's share where nothing is filtered.
Json chart_json(const std::vector<ChartPanel>& panels);

/// The same with a line a point and names on top (RFC 4180, but for the line's end, which is
/// LF). Settings are "max_coc_px=16;profile=ieee"; null is empty.
std::string chart_csv(const std::vector<ChartPanel>& panels);

}  // namespace softfocus

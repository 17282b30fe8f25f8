#pragma once
// The chart as numbers: CSV and JSON.

#include <string>
#include <vector>

#include "tools/chart/point.h"
#include "tools/chart/report/summary.h"
#include "tools/files/json.h"

namespace softfocus {

/// A list of {scene, method, settings, median_ms, pinhole_frames, psnr_db, ssim, flip,
/// flip_silhouette, flip_near, flip_focus, flip_far, hdr_flip, hdr_flip_silhouette, hdr_flip_near,
/// hdr_flip_focus, hdr_flip_far, filter_ms, rounds, on_front, best_setting, truth_samples,
/// noise_floor_flip, noise_floor_hdr_flip, noise_floor_psnr_db, picture_hash}. null: an infinite
/// PSNR, a region without pixels, the filter's share where nothing is filtered, and what needs
/// times where nothing was timed. Needs settled panels, as all here.
Json chart_json(const std::vector<ChartPanel>& panels);

/// A list of {scene, budget, measure, method, settings, error, pinhole_frames, median_ms}. A
/// budget of null is that of any time.
Json best_json(const std::vector<BestForBudget>& best);

/// A list of {method, settings, scenes, pinhole_frames_median, pinhole_frames_worst, and for flip
/// and hdr_flip: flip_ratio_median, flip_ratio_p90, flip_ratio_worst, flip_ratio_worst_scene,
/// flip_median, flip_p90, flip_worst, flip_worst_scene}. Ratios and times are null where nothing
/// was timed.
Json summary_json(const std::vector<SummaryRow>& summary);

}  // namespace softfocus

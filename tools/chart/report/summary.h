#pragma once
// Each contender over all scenes, so that no scene decides; and the best for each budget of time,
// scene by scene.

#include <array>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "tools/chart/point.h"
#include "tools/files/json.h"

namespace softfocus {

/// A number a scene, in three. NaN where there is no number.
struct OverScenes {
  double median = kNotTimed;
  double p90 = kNotTimed;  ///< nine tenths of the scenes, rounded up, have at most this
  double worst = kNotTimed;
  std::string worst_scene{};  ///< the first with the largest
};

struct SummaryRow {
  std::string method;    ///< or its series: "two-pass, d3d11"
  std::string settings;  ///< "max-coc 16"; kBestSetting: on each scene its best
  int scenes = 0;        ///< on which it can run
  OverScenes pinhole_frames{};
  RankedErrors ranked = kPictureErrors;
  /// By `ranked`: its error over the least that any contender has in its time or less. Errors
  /// below the noise of the truth count as that noise.
  std::array<OverScenes, std::tuple_size_v<RankedErrors>> ratios{};
  std::array<OverScenes, std::tuple_size_v<RankedErrors>> errors{};
};

inline constexpr std::string_view kBestSetting = "best setting";

/// A row for each contender, in the order of the first panel that has it, each series followed by
/// its best setting if it has several. Needs settled panels.
std::vector<SummaryRow> summary_of(const std::vector<ChartPanel>& panels);

/// Whether the rows have times.
bool has_times(const std::vector<SummaryRow>& summary);

/// One of a scene's numbers.
struct SceneNumber {
  double number;
  std::string scene;
};
OverScenes over_scenes(std::span<const SceneNumber> numbers);

/// In frames of the scene's pinhole.
inline constexpr std::array kBudgets{1.25, 1.5, 2.0, 3.0, 5.0, 10.0, 50.0};
inline constexpr double kAnyTime = std::numeric_limits<double>::infinity();

struct BestForBudget {
  std::string scene;
  double budget;
  std::size_t rank;  ///< by which of the panel's errors: 0 or 1
  RankedError ranked;
  const ChartPoint* point;
};

/// The contender with the least error within each budget, and in any time; of equal ones the
/// fastest, then the first. Without times only that in any time. Budgets that hold none are left
/// out. The points are those of the panels.
std::vector<BestForBudget> best_for_budgets(const std::vector<ChartPanel>& panels);

// The chart as numbers: CSV and JSON.

/// A list of {scene, method, settings, median_ms, pinhole_frames, psnr_db, ssim, flip,
/// flip_silhouette, flip_near, flip_focus, flip_far, flip_edge, hdr_flip, the same by region,
/// filter_ms, rounds, on_front, best_setting, truth_samples, noise_floor_flip,
/// noise_floor_hdr_flip, noise_floor_psnr_db, picture_hash}. null: an infinite PSNR, a region
/// without pixels, the filter's share where nothing is filtered, and what needs times where nothing
/// was timed. Needs settled panels, as all here.
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

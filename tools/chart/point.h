#pragma once
// What `chart` finds out about one contender on one scene.

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "dof/measure/measures.h"
#include "tools/chart/settings.h"

namespace softfocus {

/// How far a picture is from the truth. NaN for a region without pixels.
struct ChartErrors {
  double psnr_db = std::numeric_limits<double>::infinity();
  double ssim = 1.0;
  double flip = 0.0;
  std::array<double, kRegions> flip_by_region{};  ///< in the order of Region
};

ChartErrors chart_errors(const MeasuredPictures& measured);

/// Milliseconds, run by run: of the whole frame, from the drawing to the result, and of the
/// filter's share in it. Nothing is filtered in an accumulation: `filter_ms` is empty.
struct ChartTimes {
  std::vector<double> frame_ms;
  std::vector<double> filter_ms;
};

/// A square part of a picture.
struct Crop {
  int x = 0;
  int y = 0;
  int side = 0;
};

/// PNG files in base64, for a page that needs no other file.
struct ChartPictures {
  std::string picture;      ///< reduced
  std::string error;        ///< reduced: the heat map of FLIP
  std::string worst;        ///< where it is worst, every pixel
  std::string worst_truth;  ///< the truth there
  std::string worst_error;
};

struct ChartPoint {
  ChartEntry entry;
  std::uint64_t picture_hash = 0;
  ChartErrors errors{};
  Crop worst{};
  ChartPictures pictures{};
  ChartTimes times{};
  double median_ms = 0.0;
  bool on_front = false;  ///< no contender is both faster and nearer to the truth
};

/// A scene with all its contenders.
struct ChartPanel {
  std::string scene;
  std::string title;
  int truth_samples = 0;
  ChartErrors noise_floor{};    ///< one half of the truth's samples against the other
  std::string truth_picture{};  ///< reduced
  std::vector<ChartPoint> points{};
};

}  // namespace softfocus

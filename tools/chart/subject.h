#pragma once
// The subject of a chart: a truth, and contenders that come near it in less time.

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/lens_views/lens_view_method.h"
#include "tools/chart/point.h"
#include "tools/chart/settings.h"

namespace softfocus {

struct ChartScene;

struct ChartSubject {
  std::string_view name;    ///< of --of
  std::string_view title;   ///< of the page
  std::string_view truth;   ///< what it is: "the mean of pictures from many points of the lens"
  std::string_view sample;  ///< what it has many of: "points of the lens"
  std::vector<std::string> scenes{};  ///< unless others are named; none: all that have a file
  /// Multiples of kTruthSampleStep; 0 with truth_of.
  int truth_samples = 4096, quick_truth_samples = 512;

  /// Whether pictures are taken through the scene's lens, else through a pinhole.
  bool through_lens = true;
  /// Sampling of the truth and of the contender accumulation: jitter, and the shutter of a scene
  /// that has none of its own.
  Sampling sampling{};
  /// The camera's way around the target in a scene in which nothing moves.
  double orbit_degrees_per_frame = 0.0;

  /// The truth, calculated. Null: it is the mean of views.
  Image (*truth_of)(const ChartScene& scene, ThreadPool& pool) = nullptr;
  /// Whether the picture is a sheet of views of a turn, the sharp one too.
  bool turns = false;
  RankedErrors ranked = kPictureErrors;
  std::string_view measure{};  ///< sentences of the page on an error of its own

  /// The names that --methods takes.
  std::vector<std::string> (*methods)();
  /// The settings of one of them, as chart_entries().
  std::vector<ChartEntry> (*entries)(const std::string& method, int height_px, bool quick);
};

/// Depth of field is the first.
std::span<const ChartSubject> chart_subjects();

/// The subject of that name, or nullptr.
const ChartSubject* find_chart_subject(std::string_view name);

}  // namespace softfocus

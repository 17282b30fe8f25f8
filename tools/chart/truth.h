#pragma once
// The truth that `chart` compares contenders with, and how uncertain it is.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "tools/chart/point.h"
#include "tools/chart/scene.h"

namespace softfocus {

struct ChartTruth {
  Image picture;  ///< the mean of the first views of the sequence, or calculated
  /// The first half of the samples against the second. The picture is the mean of both: its mean
  /// square error is a fourth of their mean square difference. None of what is calculated.
  ChartErrors noise_floor;
};

/// The truth's samples are a multiple of this: two halves of whole groups.
inline constexpr int kTruthSampleStep = 2 * kSampleGroup;

/// `on_samples` is told how many are in, now and then.
ChartTruth make_truth(const ChartScene& scene, int samples,
                      const std::function<void(int)>& on_samples, ThreadPool& pool);

/// Keeps it as FILE.npy and FILE.json.
void save_truth(const ChartTruth& truth, const std::string& key, const std::filesystem::path& file);

/// The truth that was kept, if it was under that key and is whole.
std::optional<ChartTruth> load_truth(const std::string& key, const std::filesystem::path& file);

/// The truth reduced for the page, under the key of its scene's points; empty if none is kept.
void save_truth_picture(const std::string& picture, const std::string& key,
                        const std::filesystem::path& file);
std::string load_truth_picture(const std::string& key, const std::filesystem::path& file);

}  // namespace softfocus

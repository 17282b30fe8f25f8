#pragma once
// `chart`'s files to go on from, as JSON, and the keys that tell whether they are still right.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/chart/point.h"
#include "tools/chart/scene.h"
#include "tools/files/json.h"

namespace softfocus {

/// A line that differs whenever the truth could. It names the program's version, the scene's name
/// and file, size, frame, lens, sampling and two hashes: of the pinhole's picture and of that of
/// the first few samples. The hashes change with a scene's other files and with the program.
/// `measures` is measures_hash(): without it a changed measure would take over old errors.
std::string truth_key(const ChartScene& scene, const std::string& file_bytes, int samples,
                      std::uint64_t measures, ThreadPool& pool);

/// Under this a contender's errors and pictures are kept.
std::string point_key(const std::string& truth_key, const Image& truth);

/// Times also depend on this: processor, compiler, threads and vector unit.
std::string machine_key(const PoolOptions& pool);

/// The bytes of the file that load_scene() would read first; the name of a random scene, which
/// has none. Throws SceneError.
std::string scene_file_bytes(const std::string& scene,
                             const std::vector<std::filesystem::path>& from_user);

/// By the keys of chart_measures(). An infinite PSNR and a region without pixels are null; what is
/// not of the subject is left out.
Json errors_json(const ChartErrors& errors);
ChartErrors errors_of(const Json& json);

/// A point's pictures and its worst place.
Json pictures_json(const ChartPoint& point);
/// Throws JsonError, and leaves the point as it is.
void take_pictures(const Json& json, ChartPoint& point);

/// The times of all points that have some, under a key.
void save_times(const std::vector<ChartPoint>& points, const std::string& key,
                const std::filesystem::path& file);

/// Fills in the times kept under that key, for points whose pictures have the same hash.
void load_times(std::vector<ChartPoint>& points, const std::string& key,
                const std::filesystem::path& file);

// The truth that `chart` compares contenders with, and how uncertain it is.

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

}  // namespace softfocus

#pragma once
// `chart`'s files to go on from, as JSON, and the keys that tell whether they are still right.

#include <filesystem>
#include <string>
#include <vector>

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

/// A point's errors, under a key. Few points have pictures.
void save_errors(const ChartPoint& point, const std::string& key,
                 const std::filesystem::path& file);

/// Fills in what save_errors() kept under that key, if the picture's hash is the point's.
bool load_errors(ChartPoint& point, const std::string& key, const std::filesystem::path& file);

/// Pictures and the worst place, kept in the same file.
void save_pictures(const ChartPoint& point, const std::string& key,
                   const std::filesystem::path& file);
bool load_pictures(ChartPoint& point, const std::string& key, const std::filesystem::path& file);

/// The times of all points that have some, under a key.
void save_times(const std::vector<ChartPoint>& points, const std::string& key,
                const std::filesystem::path& file);

/// Fills in the times kept under that key, for points whose pictures have the same hash.
void load_times(std::vector<ChartPoint>& points, const std::string& key,
                const std::filesystem::path& file);

}  // namespace softfocus

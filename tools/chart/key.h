#pragma once
// Keys that tell `chart` whether a kept result is still right.

#include <filesystem>
#include <string>
#include <vector>

#include "tools/chart/scene.h"

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

}  // namespace softfocus

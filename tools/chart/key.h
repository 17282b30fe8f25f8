#pragma once
// Keys that tell `chart` whether a kept result is still right.

#include <filesystem>
#include <string>
#include <vector>

#include "tools/chart/scene.h"

namespace softfocus {

/// A line that differs whenever the truth could. It names the program's version, the scene's name
/// and file, size, frame, lens, samples and two hashes: of the pinhole's picture and of that of the
/// first few samples. The hashes change with a scene's other files and with the program.
std::string truth_key(const ChartScene& scene, const std::string& file_bytes, int samples,
                      ThreadPool& pool);

/// Times also depend on this: processor, compiler, threads and vector unit.
std::string machine_key(const PoolOptions& pool);

/// The bytes of the file that load_scene() would read first. Throws SceneError.
std::string scene_file_bytes(const std::string& scene,
                             const std::vector<std::filesystem::path>& from_user);

}  // namespace softfocus

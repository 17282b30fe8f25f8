#pragma once
// By what `chart` knows that what it kept is still right.

#include <filesystem>
#include <string>
#include <vector>

#include "tools/chart/scene.h"

namespace softfocus {

/// A line that differs whenever the truth could: of the program's version, the scene's name and
/// file, size, frame, lens, samples, the pinhole's picture and that of the first few samples,
/// which knows of files that a scene takes in and of changes of the program.
std::string truth_key(const ChartScene& scene, const std::string& file_bytes, int samples,
                      ThreadPool& pool);

/// What times depend on besides: processor, compiler, threads and vector unit.
std::string machine_key(const PoolOptions& pool);

/// The bytes of the file that load_scene() would read first. Throws SceneError.
std::string scene_file_bytes(const std::string& scene,
                             const std::vector<std::filesystem::path>& from_user);

}  // namespace softfocus

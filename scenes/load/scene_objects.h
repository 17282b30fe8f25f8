#pragma once
// The [[object]] and [[scatter]] tables of a scene file.

#include <filesystem>

#include "scenes/load/scene_surfaces.h"
#include "scenes/load/toml_reading.h"
#include "scenes/scene.h"

namespace softfocus {

/// Reads both into the scene, in the file's order, objects before scatters. Throws
/// SceneError.
void read_objects(Section& top, const std::filesystem::path& directory,
                  const NamedSurfaces& surfaces, Scene& scene);

}  // namespace softfocus

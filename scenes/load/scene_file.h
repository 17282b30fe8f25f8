#pragma once
// Scene files: TOML in the format of docs/scene-format.md.

#include <filesystem>
#include <string_view>

#include "scenes/scene.h"

namespace softfocus {

/// Reads a scene file and what it refers to. Throws SceneError, with the line, for
/// everything that is not as docs/scene-format.md says, unknown keys included.
Scene read_scene_file(const std::filesystem::path& file);

/// The same for a text that would stand in `file`: files that it names are looked for
/// beside that.
Scene read_scene_text(std::string_view text, const std::filesystem::path& file);

/// A scene file's title without reading the scene; empty where there is none. Throws
/// SceneError for what is no TOML.
std::string read_scene_title(const std::filesystem::path& file);

}  // namespace softfocus

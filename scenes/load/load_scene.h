#pragma once
// From a name or a file to a scene.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "raster/threads/parallel.h"
#include "scenes/files/scene_error.h"
#include "scenes/scene.h"

namespace softfocus {

// Scene files: TOML in the format of docs/scene-format.md. `pool`: the threads that make textures
// and read models; none: the calling one.

/// Reads a scene file and what it refers to. Throws SceneError, with the line, for
/// everything that is not as docs/scene-format.md says, unknown keys included.
Scene read_scene_file(const std::filesystem::path& file, ThreadPool* pool = nullptr);

/// The same for a text that would stand in `file`: files that it names are looked for
/// beside that.
Scene read_scene_text(std::string_view text, const std::filesystem::path& file,
                      ThreadPool* pool = nullptr);

/// A scene file's title without reading the scene; empty where there is none. Throws
/// SceneError if the top of the file is no TOML.
std::string read_scene_title(const std::filesystem::path& file);

/// Where scenes are looked for, in this order: the directories given by the user,
/// the source tree that the program was built from, the installed share directory.
std::vector<std::filesystem::path> scene_search_path(
    const std::vector<std::filesystem::path>& from_user);

/// One built-in or found scene, for the list.
struct SceneListing {
  std::string name;   ///< as `render` takes it: the file's stem
  std::string title;  ///< the file's `title`
  std::filesystem::path file;
};

/// Every .toml file on the path, by name; the first of a name wins.
std::vector<SceneListing> list_scenes(const std::vector<std::filesystem::path>& search_path);

/// The same without titles: no file is read.
std::vector<SceneListing> find_scenes(const std::vector<std::filesystem::path>& search_path);

/// Whether `scene` names one of the scenes without end: "random:" and what should be a number.
bool is_random_scene(std::string_view scene);

/// `scene` is a .toml file, a .gltf, .glb, .obj, .ply or .stl model (any string that ends so is a
/// path), "random:SEED" (scenes/random/random_scene.h; SEED is 0 to 2^64 - 1), or the name of a
/// scene on the path. Throws SceneError.
Scene load_scene(std::string_view scene, const std::vector<std::filesystem::path>& search_path,
                 ThreadPool* pool = nullptr);

}  // namespace softfocus

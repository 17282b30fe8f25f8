#pragma once
// The parts of a scene file that have a reader of their own. Each throws SceneError for what is
// not as docs/scene-format.md says.

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "raster/threads/parallel.h"
#include "scenes/load/toml_reading.h"
#include "scenes/scene.h"

namespace softfocus {

// --- scene_surfaces.cpp ---

/// Textures and materials by the names that the rest of the file uses.
struct NamedSurfaces {
  struct NamedTexture {
    std::uint32_t index;
    Sampler sampler;
  };
  std::map<std::string, NamedTexture> textures;
  std::map<std::string, std::uint32_t> materials;
  /// The opacity that was made of a texture, by numbers of the scene's textures.
  std::map<std::uint32_t, std::uint32_t> opacity_of_texture;
};

/// Reads the [texture.NAME] and [material.NAME] tables into the scene. `pool` may be null.
NamedSurfaces read_surfaces(Section& top, const std::filesystem::path& directory, Scene& scene,
                            ThreadPool* pool);

/// The number of the material that `key` names.
std::uint32_t material_named(const Section& section, std::string_view key, const std::string& name,
                             const NamedSurfaces& surfaces);

/// A colour: three numbers from 0 to `largest`, linear.
glm::vec3 read_colour(Section& section, std::string_view key, glm::vec3 fallback, double largest);

// --- scene_shaders.cpp ---

/// Reads the keys of a user's shaders in a [material.NAME] table: `vertex`, `fragment`, `uniforms`
/// and `textures`. Without them the material is left as it is.
void read_shaders(Section& section, const std::filesystem::path& directory,
                  const NamedSurfaces& surfaces, Scene& scene, Material& material);

// --- scene_shapes.cpp ---

/// The mesh that the section's `shape` and the keys of that shape describe, with
/// `texture_repeat` and `inside_out` applied.
Mesh read_shape(Section& section);

/// Whether `shape` is "model": a file, which read_shape() does not read.
bool is_model(Section& section);

/// The largest distance of a point of the mesh from its origin.
double bounding_radius(const Mesh& mesh);

// --- scene_objects.cpp ---

/// Reads the [[object]] and then the [[scatter]] tables into the scene, in the file's order. `pool`
/// may be null.
void read_objects(Section& top, const std::filesystem::path& directory,
                  const NamedSurfaces& surfaces, Scene& scene, ThreadPool* pool);

}  // namespace softfocus

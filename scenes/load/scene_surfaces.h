#pragma once
// The [texture.NAME] and [material.NAME] tables of a scene file.

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "scenes/load/toml_reading.h"
#include "scenes/scene.h"

namespace softfocus {

/// What the rest of the file refers to by name.
struct NamedSurfaces {
  struct NamedTexture {
    std::uint32_t index;
    Sampler sampler;
  };
  std::map<std::string, NamedTexture> textures;
  std::map<std::string, std::uint32_t> materials;
};

/// Reads both tables into the scene. Throws SceneError.
NamedSurfaces read_surfaces(Section& top, const std::filesystem::path& directory, Scene& scene);

/// The material that `key` names. Throws SceneError where it names none.
std::uint32_t material_named(const Section& section, std::string_view key, const std::string& name,
                             const NamedSurfaces& surfaces);

/// The texts of a file's colours: three numbers, linear.
glm::vec3 read_colour(Section& section, std::string_view key, glm::vec3 fallback, double largest);

}  // namespace softfocus

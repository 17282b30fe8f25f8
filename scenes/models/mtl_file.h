#pragma once
// MTL material libraries, read by tinyobjloader.

#include <filesystem>
#include <glm/vec2.hpp>
#include <map>
#include <string>
#include <vector>

#include "scenes/scene.h"

namespace softfocus {

/// How a material places its textures, as -s, -o and -t of its map say:
/// uv * scale + offset + turbulence * waves of uv.
struct UvPlacement {
  glm::vec2 scale{1.0f};
  glm::vec2 offset{0.0f};
  glm::vec2 turbulence{0.0f};
  bool operator==(const UvPlacement&) const = default;
};

/// Places the texture coordinates of a mesh, whose v runs downwards. A triangle's corners alone are
/// moved: turbulence shows on meshes that are fine enough.
void place_uvs(Mesh& mesh, const UvPlacement& placement);

/// The materials of libraries so far. Those that name the same file share its texture.
struct MtlMaterials {
  std::vector<Texture> textures;
  std::map<std::string, Material> by_name;
  std::map<std::string, UvPlacement> placements;  ///< of those that have one, by name
  std::map<std::string, std::uint32_t> texture_of_file;
  /// The opacity that was made of a texture, by their numbers.
  std::map<std::uint32_t, std::uint32_t> opacity_of_texture;
  std::vector<std::string> warnings;
  std::vector<std::filesystem::path> files;  ///< the libraries and textures that were read
};

/// Adds the materials of a library; the first of a name stays. From Kd, Ka, Ks, Ns,
/// map_Kd, d (Tr is 1 - d, and d wins over it) and map_d, in letters of either case. As
/// exporters write them:
///   one number   is grey; `spectral` and `xyz` are neutral grey, with a warning
///   a number that is none, or negative   is passed over, with a warning
///   Ka black or white   means nothing; Kd takes its place
///   Kd black under a map_Kd   means white
///   Ns   is rounded to a whole number from 1 to 1024; 0 or less is no highlight
///   Tr 1 without d   is opaque, with a warning
///   d    is cut to 0 to 1; -halo is passed over
///   map_d   is read as make_opacity_texture() says
/// Of a map's options -s, -o, -t and -clamp are obeyed, the others told once. Those of map_Kd
/// place map_d too.
/// Texture paths are relative to the library, or else looked for beside it by their
/// last part. A library or texture that is missing, or in a format other than PNG and
/// JPEG, is a warning. Throws SceneError for a texture that is there and unreadable.
void load_mtl(const std::filesystem::path& library, MtlMaterials& materials);

/// Adds a material that is a texture alone; `file` names it. Warns and throws as load_mtl().
void add_picture(const std::filesystem::path& file, const std::string& picture,
                 MtlMaterials& materials);

/// Stands in for a missing material.
Material neutral_grey();

}  // namespace softfocus

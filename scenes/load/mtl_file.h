#pragma once
// MTL material libraries, read by tinyobjloader.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "scenes/scene.h"

namespace softfocus {

/// The materials of libraries so far. Those that name the same file share its texture.
struct MtlMaterials {
  std::vector<Texture> textures;
  std::map<std::string, Material> by_name;
  std::map<std::string, std::uint32_t> texture_of_file;
  /// The opacity that was made of a texture, by their numbers.
  std::map<std::uint32_t, std::uint32_t> opacity_of_texture;
  std::vector<std::string> warnings;
  std::vector<std::filesystem::path> files;  ///< the libraries and textures that were read
};

/// Adds the materials of a library; the first of a name stays. From Kd, Ka, Ks, Ns,
/// map_Kd, d (Tr is 1 - d, and d wins over it) and map_d. As exporters write them:
///   Ka black or white   means nothing; Kd takes its place
///   Kd black under a map_Kd   means white
///   Ns   is rounded to a whole number from 1 to 1024
///   d    is cut to 0 to 1; NaN is 0; -halo is passed over
///   map_d   is read as make_opacity_texture() says
/// Texture paths are relative to the library, or else looked for beside it by their
/// last part. A library or texture that is missing, or in a format other than PNG and
/// JPEG, is a warning. Throws SceneError for a texture that is there and unreadable.
void load_mtl(const std::filesystem::path& library, MtlMaterials& materials);

/// Stands in for a missing material.
Material neutral_grey();

}  // namespace softfocus

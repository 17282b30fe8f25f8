#pragma once
// Meshes of a glTF file where its nodes put them, joined by material.

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <map>
#include <span>
#include <tuple>
#include <vector>

#include "scenes/models/gltf_file.h"

namespace softfocus {

/// What has one material. It grows in binary64 until the model's middle is known.
struct GltfPart {
  std::uint32_t material;
  bool has_uvs, has_colours;
  std::vector<glm::dvec3> positions{};
  Mesh mesh{};
};

/// A part for each material, with or without texture coordinates and vertex colours.
struct GltfParts {
  std::vector<GltfPart> parts{};
  std::map<std::tuple<std::uint32_t, bool, bool>, std::size_t> number_of{};
  std::size_t corners = 0;  ///< of all
};

/// Adds a node's mesh. `worlds` are the matrices of all nodes, null outside the scene.
void add_mesh(GltfFile& file, const tinygltf::Node& node, const glm::dmat4& to_world,
              std::span<const glm::dmat4* const> worlds, GltfParts& parts);

struct ModelBox {
  glm::dvec3 low, high;
};

/// Puts the parts into the model, less its middle if that is far. Returns the box that holds them.
ModelBox finish_parts(GltfFile& file, std::vector<GltfPart>& parts);

}  // namespace softfocus

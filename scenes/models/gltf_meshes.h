#pragma once
// Meshes of a glTF file where its nodes put them, joined by material.

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <map>
#include <memory>
#include <span>
#include <tuple>
#include <vector>

#include "scenes/models/gltf_file.h"

namespace softfocus {

/// A node in the file's scene.
struct PlacedNode {
  int number;
  glm::dmat4 to_world;  ///< at frame 0
  /// Of the node, or of the next above that moves; null: none does.
  std::shared_ptr<const NodeMotion> motion;
  glm::dmat4 to_motion;  ///< the matrix to there, or to the world
  int moving = 0;        ///< nodes that do, from it upwards
};

/// What has one material and moves as one. It grows in binary64 until the model's middle is known.
struct GltfPart {
  std::uint32_t material;
  bool has_uvs, has_colours;
  std::shared_ptr<const NodeMotion> motion;
  std::vector<glm::dvec3> positions{};  ///< where it moves, in the coordinates of what moves it
  Mesh mesh{};
};

/// A part for each material and motion, with or without texture coordinates and vertex colours.
struct GltfParts {
  std::vector<GltfPart> parts{};
  std::map<std::tuple<std::uint32_t, bool, bool, const NodeMotion*>, std::size_t> number_of{};
  std::size_t corners = 0;  ///< of all
};

/// Adds a node's mesh. `nodes` are all by number, null outside the scene.
void add_mesh(GltfFile& file, const PlacedNode& at, std::span<const PlacedNode* const> nodes,
              GltfParts& parts);

/// Puts the parts into the model, those that stand still less its middle if that is far. Returns
/// the box that holds them at all frames.
ModelBox finish_parts(GltfFile& file, std::vector<GltfPart>& parts);

}  // namespace softfocus

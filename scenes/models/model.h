#pragma once
// A model as its file has it, whatever the format.

#include <array>
#include <cstddef>
#include <filesystem>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "raster/threads/parallel.h"
#include "scenes/models/mtl_file.h"
#include "scenes/models/node_motion.h"
#include "scenes/scene.h"

namespace softfocus {

/// Textures and materials are numbered from 0.
struct Model {
  std::vector<Texture> textures;
  std::vector<Material> materials;
  /// What has one material.
  struct Part {
    Mesh mesh;
    std::uint32_t material = 0;
    UvPlacement placement{};                     ///< of the material's textures, not yet applied
    std::shared_ptr<const NodeMotion> motion{};  ///< null: it stands still
  };
  std::vector<Part> parts;
  /// What was subtracted from the file's positions, but of parts that move.
  glm::dvec3 origin{0.0};
  /// What was missing, a line each.
  std::vector<std::string> warnings;
  std::vector<std::filesystem::path> files;  ///< the model, its libraries and their textures
  // For a model that is a scene by itself.
  std::optional<Camera> camera{};  ///< without near and far
  std::vector<Light> lights{};
};

/// A box that grows.
struct ModelBox {
  glm::dvec3 low{std::numeric_limits<double>::infinity()};
  glm::dvec3 high{-std::numeric_limits<double>::infinity()};

  void add(glm::dvec3 p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  std::array<glm::dvec3, 8> corners() const {
    std::array<glm::dvec3, 8> made;
    for (std::size_t i = 0; i < 8; ++i) {
      made[i] = {(i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y,
                 (i & 4) != 0 ? high.z : low.z};
    }
    return made;
  }
};

/// Whether a name is a model's file: ".gltf", ".glb", ".obj", ".ply", ".stl".
bool is_model_name(std::string_view name);

/// load_gltf_model(), load_obj_model(), parse_ply() or parse_stl(), by the end of the name.
Model load_model(const std::filesystem::path& file, ThreadPool* pool);

// What readers share.

/// Coordinates beyond this are taken for damage; their squares are still floats.
inline constexpr float kLargestCoordinate = 1e9f;

/// The middle of a box, in whole units, where it is so far from the origin that binary32 would lose
/// more than six bits of what the box holds; else the origin.
glm::dvec3 far_middle(glm::dvec3 low, glm::dvec3 high);

/// "FILE: is far from the origin ...".
std::string far_warning(const std::filesystem::path& file, glm::dvec3 subtracted);

}  // namespace softfocus

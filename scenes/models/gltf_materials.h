#pragma once
// Materials and textures of a glTF file.

#include "scenes/models/gltf_file.h"

namespace softfocus {

/// What a material shows: its base colour, or the light that it gives off, if that is black by its
/// factor.
struct ShownColour {
  glm::dvec3 factor{0.0};
  int texture = -1, uv_set = 0;
  const tinygltf::ExtensionMap* extensions = nullptr;  ///< of the texture
  bool shines = false;
};

ShownColour shown_colour(GltfFile& file, const tinygltf::Material& from);

/// By the rule of gltf_model.h. Its textures become the model's.
Material material_of(GltfFile& file, const tinygltf::Material& from);

}  // namespace softfocus

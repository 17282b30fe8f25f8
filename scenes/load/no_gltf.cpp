// Stands in for gltf_model.cpp where there is no tinygltf.

#include "scenes/files/scene_error.h"
#include "scenes/load/gltf_model.h"

namespace softfocus {

Model load_gltf_model(const std::filesystem::path& file) {
  throw SceneError(file.string() +
                   ": this program was built without glTF (tinygltf); an .obj model would do");
}

}  // namespace softfocus

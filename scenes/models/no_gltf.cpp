// Stands in for the other gltf files where there is no tinygltf.

#include "scenes/files/scene_error.h"
#include "scenes/models/gltf_model.h"

namespace softfocus {

Model load_gltf_model(const std::filesystem::path& path) {
  throw SceneError(path.string() +
                   ": this program was built without glTF (tinygltf); an .obj model would do");
}

}  // namespace softfocus

// Any bytes as a material library: materials, or a SceneError.

#include "scenes/files/scene_error.h"
#include "scenes/models/mtl_file.h"
#include "tests/fuzz/fuzz_input.h"

int softfocus::fuzz_mtl(const std::uint8_t* data, std::size_t size) {
  try {
    MtlMaterials materials;
    load_mtl(fuzz_file(data, size, ".mtl"), materials);
  } catch (const SceneError&) {
  }
  return 0;
}

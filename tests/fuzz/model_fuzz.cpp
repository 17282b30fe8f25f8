// Any bytes as a model: one that can be drawn, or a SceneError.

#include "scenes/draw/draw_scene.h"
#include "scenes/files/scene_error.h"
#include "scenes/load/model_scene.h"
#include "tests/fuzz/fuzz_input.h"

namespace {

int draw_model(const std::filesystem::path& file) {
  using namespace softfocus;
  try {
    const Scene scene = make_model_scene(load_model(file, nullptr), "fuzz");
    ThreadPool pool(1);
    draw_scene(scene, camera_matrices(scene.camera, 0, 16, 16), 0, 16, 16, Profile{}, pool);
  } catch (const SceneError&) {
  }
  return 0;
}

}  // namespace

int softfocus::fuzz_obj(const std::uint8_t* data, std::size_t size) {
  return draw_model(fuzz_file(data, size, ".obj"));
}

int softfocus::fuzz_gltf(const std::uint8_t* data, std::size_t size) {
  return draw_model(fuzz_file(data, size, ".gltf"));
}

int softfocus::fuzz_ply(const std::uint8_t* data, std::size_t size) {
  return draw_model(fuzz_file(data, size, ".ply"));
}

int softfocus::fuzz_stl(const std::uint8_t* data, std::size_t size) {
  return draw_model(fuzz_file(data, size, ".stl"));
}

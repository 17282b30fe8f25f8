// Any bytes as an OBJ model: a model that can be drawn, or a SceneError.

#include "scenes/draw/draw_scene.h"
#include "scenes/files/scene_error.h"
#include "scenes/load/model_scene.h"
#include "tests/fuzz/fuzz_input.h"

int softfocus::fuzz_obj(const std::uint8_t* data, std::size_t size) {
  try {
    const Scene scene = make_model_scene(load_obj_model(fuzz_file(data, size, ".obj")), "fuzz");
    ThreadPool pool(1);
    draw_scene(scene, camera_matrices(scene.camera, 0, 16, 16), 0, 16, 16, Profile{}, pool);
  } catch (const SceneError&) {
  }
  return 0;
}

// Any text as a scene file: a scene that can be drawn, or a SceneError.

#include <string_view>

#include "scenes/draw/draw_scene.h"
#include "scenes/load/scene_error.h"
#include "scenes/load/scene_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace softfocus;
  // What large counts would cost is no finding.
  constexpr std::size_t kMostTriangles = 20000;
  try {
    const std::string_view text{reinterpret_cast<const char*>(data), size};
    const Scene scene = read_scene_text(text, "fuzz.toml");
    std::size_t triangles = 0;
    for (const Object& object : scene.objects) {
      triangles += scene.meshes[object.mesh].indices.size() / 3;
    }
    if (triangles > kMostTriangles) return 0;
    ThreadPool pool(1);
    draw_scene(scene, camera_matrices(scene.camera, 1, 16, 16), 1, 16, 16, Profile{}, pool);
  } catch (const SceneError&) {
  }
  return 0;
}

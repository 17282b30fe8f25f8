#include "tools/crosscheck/shadowed_frame.h"

#include <utility>

namespace softfocus {

ShadowedFrame draw_shadowed_frame(const Bench& bench, const std::string& scene, ShadowKind kind,
                                  const ShadowMapSettings& map, int width, int height) {
  Scene loaded = loaded_scene(scene);
  set_shadows(loaded, kind);
  for (Light& light : loaded.lights) light.map = map;
  PreparedScene prepared = prepare_scene(loaded, bench.profile, bench.pool);
  const CameraMatrices camera = camera_matrices(loaded.camera, 0.0, width, height);
  Image picture = make_image(Format::rgba16f, width, height);
  draw_scene(prepared, camera, 0.0, picture, bench.pool);
  ShadowedFrame frame{
      prepared.shadows,
      camera.eye,
      {multiply(camera.eye_to_clip, camera.world_to_eye), width, height, bench.profile},
      {}};
  frame.draws = cut_shadows(*frame.shadows, camera, width, height, bench.pool);
  return frame;
}

std::string name_and_size(const std::string& scene, int width, int height) {
  return scene + ' ' + std::to_string(width) + 'x' + std::to_string(height);
}

}  // namespace softfocus

// Stage `shadow`: shadows projected onto what a camera sees, drawn by both sides.

#include "raster/images/texel.h"
#include "scenes/draw/shadowed_layers.h"
#include "scenes/load/load_scene.h"
#include "tools/crosscheck/cases.h"
#include "tools/gl/shadows_on_gl.h"

namespace softfocus {
namespace {

Image mask_image(std::span<const std::uint8_t> mask, int width, int height) {
  Image image = make_image(Format::r32f, width, height);
  for (int y = 0; y < height; ++y) {
    const auto to = row<float>(image, y);
    for (std::size_t x = 0; x < to.size(); ++x) {
      to[x] = mask[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + x];
    }
  }
  return image;
}

void shadow_both(const Bench& bench, Tally& tally, const std::string& name, int width, int height) {
  Scene scene = load_scene(name, scene_search_path({}));
  set_shadows(scene, ShadowKind::projected);
  PreparedScene prepared = prepare_scene(scene, bench.profile, bench.pool);
  const CameraMatrices camera = camera_matrices(scene.camera, 0.0, width, height);
  Image picture = make_image(Format::rgba16f, width, height);
  draw_scene(prepared, camera, 0.0, picture, bench.pool);
  const SceneShadows& shadows = *prepared.shadows;
  const MaskDraws draws = cut_shadows(shadows, camera, width, height, bench.pool);
  const GlShadows on_gl = make_gl_shadows(bench.gl, bench.shaders, draws,
                                          static_cast<int>(scene.lights.size()), width, height);
  draw(on_gl);
  add_pictures(tally, mask_image(read_mask(on_gl, draws.dark), width, height),
               mask_image(shadows.masks[0], width, height));
}

}  // namespace

void add_shadow_cases(std::vector<Case>& cases) {
  const auto add = [&](const std::string& scene, int width, int height, bool quick) {
    cases.push_back({"shadow", scene + ' ' + std::to_string(width) + 'x' + std::to_string(height),
                     quick, quick, [=](const Bench& bench, Tally& tally) {
                       shadow_both(bench, tally, scene, width, height);
                     }});
  };
  for (const std::string scene : {"figures", "cube-room", "sphere-world"}) {
    add(scene, 97, 61, true);
    add(scene, 1024, 1024, false);
  }
  add("near-fence", 512, 512, false);
  add("random:205", 512, 512, false);
}

}  // namespace softfocus

// Stage `shadow`: shadows projected onto what a camera sees, drawn by both sides.

#include "tools/crosscheck/shadowed_frame.h"
#include "tools/gl/shadows_on_gl.h"

namespace softfocus {
namespace {

void shadow_both(const Bench& bench, Tally& tally, const std::string& name, int width, int height) {
  const ShadowedFrame frame =
      draw_shadowed_frame(bench, name, ShadowKind::projected, {}, width, height);
  const SceneShadows& shadows = *frame.shadows;
  const GlShadows on_gl = make_gl_shadows(bench.gl, bench.shaders, frame.draws,
                                          static_cast<int>(shadows.lights.size()), width, height);
  draw(on_gl);
  const std::vector<std::uint8_t> drawn = read_mask(on_gl, frame.draws.dark);
  const auto picture_of = [&](std::span<const std::uint8_t> mask) {
    return numbers_image(mask, width, height);
  };
  add_pictures(tally, picture_of(drawn), picture_of(shadows.masks[0]));
}

}  // namespace

void add_shadow_cases(std::vector<Case>& cases) {
  const auto add = [&](const std::string& scene, int width, int height, bool quick) {
    cases.push_back({"shadow", name_and_size(scene, width, height), quick, quick,
                     [=](const Bench& bench, Tally& tally) {
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

// Stage `shadow-map`: sides of shadow maps from the same cut casters, and what pixels find in them.

#include "tools/crosscheck/shadowed_frame.h"
#include "tools/gl/maps_on_gl.h"

namespace softfocus {
namespace {

// For each pixel, how many of the kernel's texels shade it.
std::vector<std::uint8_t> blocked_of(const ShadowedFrame& frame, std::size_t light) {
  const SceneShadows& shadows = *frame.shadows;
  const int kernel = shadows.maps[light].settings.kernel;
  std::vector<std::uint8_t> blocked = shadows.shares[0][light];
  blocked.resize(shadows.seen[0].size());
  for (std::size_t i = 0; i < blocked.size(); ++i) {
    const bool is_new = (shadows.masks[0][i] & ~frame.draws.dark[i] & 1u << light) != 0;
    if (is_new) blocked[i] = static_cast<std::uint8_t>(kernel * kernel);
  }
  return blocked;
}

void map_both(const Bench& bench, Tally& tally, const std::string& scene,
              const ShadowMapSettings& settings, int width, int height) {
  const ShadowedFrame frame =
      draw_shadowed_frame(bench, scene, ShadowKind::map, settings, width, height);
  const SceneShadows& shadows = *frame.shadows;
  for (std::size_t light = 0; light < shadows.lights.size(); ++light) {
    const ShadowMap& map = shadows.maps[light];
    const std::string of_light = "light " + std::to_string(light);
    GlMap on_gl = make_gl_map(bench.gl, bench.shaders, settings);
    for (const MapSide& side : map.sides) {
      const bool is_drawn = !side.nearness.empty();
      add_side(on_gl, is_drawn
                          ? cut_casters(shadows.facets, map.light, settings.size, side, bench.pool)
                          : std::vector<CutCasters>{});
    }
    draw(on_gl);
    for (std::size_t i = 0; i < map.sides.size(); ++i) {
      const std::span<const float> nearness = map.sides[i].nearness;
      if (nearness.empty()) continue;
      add_pictures(tally, read_colour(on_gl.sides[i].target, 0),
                   numbers_image(nearness, settings.size, settings.size),
                   of_light + ", side " + std::to_string(i));
    }
    const std::vector<PixelComparison> compared =
        pixel_comparisons(shadows.facets, map, static_cast<int>(light), shadows.seen[0], frame.view,
                          frame.eye, frame.draws.dark, bench.pool);
    const std::vector<std::uint8_t> blocked = blocked_of(frame, light);
    add_pictures(tally, look_up(on_gl, compared, width, height),
                 numbers_image(std::span<const std::uint8_t>{blocked}, width, height),
                 of_light + ", blocked texels");
  }
}

}  // namespace

void add_shadow_map_cases(std::vector<Case>& cases) {
  const auto add = [&](const std::string& scene, const ShadowMapSettings& settings, int width,
                       int height, bool quick) {
    std::string name = name_and_size(scene, width, height) + ' ' + std::to_string(settings.size);
    if (settings.kernel > 1) name += "-kernel" + std::to_string(settings.kernel);
    if (settings.cascades > 1) name += "-cascades" + std::to_string(settings.cascades);
    cases.push_back({"shadow-map", name, quick, quick, [=](const Bench& bench, Tally& tally) {
                       map_both(bench, tally, scene, settings, width, height);
                     }});
  };
  for (const std::string scene : {"figures", "cube-room", "sphere-world"}) {
    add(scene, {.size = 64, .kernel = 3, .cascades = 2}, 97, 61, true);
    add(scene, {.size = 1024}, 1024, 1024, false);
  }
  add("sphere-world", {.size = 1024, .kernel = 5, .cascades = 4}, 512, 512, false);
  add("near-fence", {.size = 1000, .kernel = 9, .fits_camera = false}, 512, 512, false);
  add("random:205", {.size = 333, .kernel = 3}, 512, 512, false);
}

}  // namespace softfocus

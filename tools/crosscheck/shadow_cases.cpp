// Stage `shadow`: shadows projected onto what a camera sees, drawn by both sides.

#include "tools/crosscheck/shadow_cases.h"

#include <utility>

#include "tools/gl/shadows_on_gl.h"

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

// Stage `shadow-map`: sides of shadow maps from the same cut casters, and what pixels find in them.

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

// Stage `shadow-volume`: faces of shadow volumes before or behind each pixel's sample, counted.

namespace {

void volumes_both(const Bench& bench, Tally& tally, const std::string& scene, VolumeCount count,
                  int width, int height) {
  const ShadowedFrame frame =
      draw_shadowed_frame(bench, scene, ShadowKind::volumes, {}, width, height);
  const SceneShadows& shadows = *frame.shadows;
  for (std::size_t light = 0; light < shadows.lights.size(); ++light) {
    std::vector<std::uint8_t> dark = frame.draws.dark;
    const VolumeCounts counted =
        count_volumes(shadows.facets, shadows.joined, shadows.volumes[light],
                      shadows.projected[light].lit, static_cast<std::uint8_t>(1u << light),
                      shadows.seen[0], frame.view, frame.eye, count, dark, bench.pool);
    const GlVolumes on_gl = make_gl_volumes(bench.gl, bench.shaders, shadows.volumes[light],
                                            counted, frame.view, frame.eye, count);
    draw(on_gl);
    add_pictures(tally, read_colour(on_gl.target, 0),
                 numbers_image(std::span<const std::int64_t>{counted.counts}, width, height),
                 "light " + std::to_string(light));
  }
}

}  // namespace

void add_shadow_volume_cases(std::vector<Case>& cases) {
  const auto add = [&](const std::string& scene, VolumeCount count, int width, int height,
                       bool quick, bool slow_too) {
    const std::string name = name_and_size(scene, width, height) +
                             (count == VolumeCount::z_pass ? " z-pass" : " z-fail");
    cases.push_back({"shadow-volume", name, quick, slow_too, [=](const Bench& bench, Tally& tally) {
                       volumes_both(bench, tally, scene, count, width, height);
                     }});
  };
  for (const VolumeCount count : {VolumeCount::z_fail, VolumeCount::z_pass}) {
    add("near-fence", count, 65, 41, true, true);
    // Seconds each on a driver that is slow: of a point light one is enough to be quick.
    add("cube-room", count, 33, 21, count == VolumeCount::z_fail, true);
    add("figures", count, 33, 21, false, true);
    for (const std::string scene : {"figures", "cube-room"}) {
      add(scene, count, 256, 256, false, false);
    }
  }
  for (const std::string scene : {"figures", "cube-room", "sphere-world"}) {
    add(scene, VolumeCount::z_fail, 1024, 1024, false, false);
  }
  add("near-fence", VolumeCount::z_fail, 512, 512, false, false);
  add("random:205", VolumeCount::z_fail, 512, 512, false, false);
}

}  // namespace softfocus

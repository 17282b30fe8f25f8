// Stage `shadow-volume`: faces of shadow volumes before or behind each pixel's sample, counted.

#include "tools/crosscheck/shadowed_frame.h"
#include "tools/gl/volumes_on_gl.h"

namespace softfocus {
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

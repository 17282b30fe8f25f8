// softfocus relief turn --rival octahedral: the same turn by an octahedral impostor atlas.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "raster/numbers/vector_math.h"
#include "scenes/relief/impostors/octahedral_atlas.h"
#include "tools/cli/commands.h"
#include "tools/relief/turn_frames.h"

namespace softfocus {

int turn_octahedral(const ReliefOptions& options) {
  TurnStage stage{options};
  const glm::dvec3 arm = stage.camera.position - stage.camera.target;
  const double distance = std::sqrt(dot(arm, arm)), radius_m = stage.maker.radius_m;
  // As sharp as an impostor's relief: a texel is a pixel, at the nearest point of the sphere.
  const double across = options.texels_per_pixel *
                        pixels_across(options.size.height, 2.0 * radius_m, distance - radius_m,
                                      1.0 / std::fabs(turned_camera(stage, 0.0).eye_to_clip[1][1]));
  const int texels = std::clamp(static_cast<int>(std::ceil(std::fmin(across, kMostReliefSize))) + 2,
                                4, kMostReliefSize);
  const OctahedralForm form{.views = options.views,
                            .hemisphere = options.hemisphere,
                            .texels = texels,
                            .depth_bits = options.depth_bits,
                            .with_normals = false,
                            .distance_m = distance};
  std::optional<OctahedralAtlas> atlas;
  const double made_ms =
      milliseconds_of([&] { atlas = make_octahedral_atlas(stage.maker, form, stage.pool); });
  const int width = options.size.width, height = options.size.height;
  std::printf("%s: %zu triangles, %d frames of %dx%d; octahedral atlas, parallax %d\n",
              stage.scene.name.c_str(), triangle_count(stage.scene), options.frames, width, height,
              options.parallax);
  std::printf("%dx%d views of a %s, %dx%d texels each: %.2f MB, drawn in %.1f ms\n", options.views,
              options.views, options.hemisphere ? "hemisphere" : "sphere", texels, texels,
              static_cast<double>(bytes_of(*atlas)) / 1e6, made_ms);
  turn_drawn_once(stage, "atlas", [&](const CameraMatrices& camera) {
    draw_octahedral(*atlas, camera, options.parallax, stage.shown, stage.pool);
    return octahedral_area(*atlas, camera, width, height);
  });
  return kDone;
}

}  // namespace softfocus

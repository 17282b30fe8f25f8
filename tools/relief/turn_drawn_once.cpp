// softfocus relief turn --box and --rival octahedral: the same turn by what was drawn once: six
// faces, or an octahedral impostor atlas.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <optional>

#include "raster/numbers/half.h"
#include "raster/numbers/vector_math.h"
#include "scenes/relief/impostors/octahedral_atlas.h"
#include "scenes/relief/impostors/relief_box.h"
#include "tools/cli/commands.h"
#include "tools/cli/timing.h"
#include "tools/relief/turn_frames.h"

namespace softfocus {
namespace {

/// Lays something over the stage's blank picture, and returns the part that it may have changed.
using DrawTurned = std::function<Rectangle(const CameraMatrices&)>;

/// A turn of something that was drawn once, beside redrawing; prints times, named by `what`, and
/// errors. `measured` is called at each measured frame.
void turn_drawn_once(TurnStage& stage, const char* what, const DrawTurned& draw,
                     const std::function<void(const CameraMatrices&)>& measured = {}) {
  TurnErrors errors;
  std::vector<double> redrawn_ms, shown_ms;
  Rectangle changed{0, 0, 0, 0};
  redraw(stage, turned_camera(stage, 0.0), stage.scene.lights);  // warms up
  for (int frame = 0; frame < stage.options.frames; ++frame) {
    const CameraMatrices camera = turned_camera(stage, frame);
    redrawn_ms.push_back(milliseconds_of([&] { redraw(stage, camera, stage.scene.lights); }));
    shown_ms.push_back(milliseconds_of([&] {
      clear_area(stage.blank, changed, stage.shown, stage.pool);
      changed = draw(camera);
    }));
    if (frame % stage.options.every != 0) continue;
    measure_frame(stage, frame, stage.shown, errors);
    if (measured) measured(camera);
  }
  const double redrawn_mean = mean_of(redrawn_ms), shown_mean = mean_of(shown_ms);
  std::printf("ms a frame: redrawn %.3f, %s %.3f, ratio %.2f; medians: redrawn %.3f, %s %.3f\n",
              redrawn_mean, what, shown_mean, redrawn_mean / shown_mean, sorted_at(redrawn_ms, 0.5),
              what, sorted_at(shown_ms, 0.5));
  print_errors(errors);
}

}  // namespace

int turn_box(const ReliefOptions& options) {
  TurnStage stage{options};
  const BoxForm form{std::max(options.texels.width, options.texels.height), options.depth_bits};
  ReliefBox box;
  const double made_ms =
      milliseconds_of([&] { box = draw_relief_box(stage.maker, form, stage.pool); });
  BoxMemory memory;
  std::size_t unseen = 0, unhad = 0, most_bytes = 0;
  const auto [width, height] = options.size;
  std::printf("%s: %zu triangles, %d frames of %dx%d; six faces, drawn in %.1f ms\n",
              stage.scene.name.c_str(), triangle_count(stage.scene), options.frames, width, height,
              made_ms);
  turn_drawn_once(
      stage, "box",
      [&](const CameraMatrices& camera) {
        draw_box(box, camera, warp_rule(options), memory, stage.shown, stage.pool);
        return Rectangle{0, 0, options.size.width, options.size.height};
      },
      [&](const CameraMatrices& camera) {
        most_bytes = std::max(most_bytes, bytes_of(box) + bytes_of(memory));
        const float far_m = half_to_float(stage.background_depth);
        for (const FacePoint had : unseen_pixels(box, camera, stage.redrawn, far_m, stage.pool)) {
          unseen += had != FacePoint::by_seen ? 1 : 0;
          unhad += had == FacePoint::by_none ? 1 : 0;
        }
      });
  std::printf("%.2f MB; %zu show what no seen face has, %zu what no face has\n",
              static_cast<double>(most_bytes) / 1e6, unseen, unhad);
  return kDone;
}

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

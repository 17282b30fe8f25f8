// softfocus relief turn --rival octahedral: the same turn by an octahedral impostor atlas.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "raster/images/texel.h"
#include "raster/numbers/half.h"
#include "raster/numbers/vector_math.h"
#include "scenes/relief/octahedral_atlas.h"
#include "tools/cli/commands.h"
#include "tools/relief/turn_frames.h"

namespace softfocus {

int turn_octahedral(const ReliefOptions& options) {
  const TurnPictures pictures = turn_pictures(options);
  const Scene scene = relief_scene(options);
  ThreadPool pool{options.pool.threads, options.pool.isa};
  const int width = options.size.width, height = options.size.height;
  ReliefMaker maker = prepare_relief(scene, options.frame, pool);
  PreparedScene prepared = prepare_scene(scene, Profile{}, pool);
  const Camera camera = turn_camera(scene, maker, options);
  const glm::dvec3 arm = camera.position - camera.target;
  const double distance = std::sqrt(dot(arm, arm));

  // As sharp as an impostor's relief: a texel is a pixel, at the nearest point of the sphere.
  const CameraMatrices first = camera_matrices(camera, 0.0, width, height);
  const double across = options.texels_per_pixel *
                        pixels_across(height, 2.0 * maker.radius_m, distance - maker.radius_m,
                                      1.0 / std::fabs(first.eye_to_clip[1][1]));
  const int texels = std::clamp(static_cast<int>(std::ceil(std::fmin(across, kMostReliefSize))) + 2,
                                4, kMostReliefSize);
  std::optional<OctahedralAtlas> atlas;
  const double made_ms = milliseconds_of([&] {
    atlas = make_octahedral_atlas(maker,
                                  {.views = options.views,
                                   .hemisphere = options.hemisphere,
                                   .texels = texels,
                                   .depth_bits = options.depth_bits,
                                   .with_normals = false,
                                   .distance_m = distance},
                                  pool);
  });

  const glm::vec4 clear = turn_background(scene, camera);
  const std::uint16_t background_depth = float_to_half(clear.w, HalfRounding::nearest_even);
  Image redrawn = make_image(Format::rgba16f, width, height);
  Image shown = make_image(Format::rgba16f, width, height);
  clear_image(shown, clear, Profile{});
  const Image blank = shown;
  prepared.depth = make_image(Format::r32f, width, height);
  TurnErrors errors;
  Rectangle changed{0, 0, 0, 0};
  std::vector<double> redrawn_ms, shown_ms;
  for (int frame = 0; frame < options.frames; ++frame) {
    const CameraMatrices matrices = camera_matrices(camera, frame, width, height);
    const auto redraw = [&] {
      redraw_turned(prepared, matrices, options, scene.lights, clear, redrawn, pool);
    };
    if (frame == 0) redraw();  // warms up
    redrawn_ms.push_back(milliseconds_of(redraw));
    shown_ms.push_back(milliseconds_of([&] {
      clear_area(blank, changed, shown, pool);
      draw_octahedral(*atlas, matrices, options.parallax, shown, pool);
      changed = octahedral_area(*atlas, matrices, width, height);
    }));
    if (frame % options.every != 0) continue;
    measure_frame(redrawn, shown, background_depth, pool, errors);
    write_pair(pictures, frame, redrawn, shown);
  }

  std::printf("%s: %zu triangles, %d frames of %dx%d; octahedral atlas, parallax %d\n",
              scene.name.c_str(), triangle_count(scene), options.frames, width, height,
              options.parallax);
  std::printf("%dx%d views of a %s, %dx%d texels each: %.2f MB, drawn in %.1f ms\n", options.views,
              options.views, options.hemisphere ? "hemisphere" : "sphere", texels, texels,
              static_cast<double>(bytes_of(*atlas)) / 1e6, made_ms);
  const double redrawn_mean = mean_of(redrawn_ms), shown_mean = mean_of(shown_ms);
  std::printf(
      "ms a frame: redrawn %.3f, atlas %.3f, ratio %.2f; medians: redrawn %.3f, atlas "
      "%.3f\n",
      redrawn_mean, shown_mean, redrawn_mean / shown_mean, sorted_at(redrawn_ms, 0.5),
      sorted_at(shown_ms, 0.5));
  print_errors(errors);
  return kDone;
}

}  // namespace softfocus

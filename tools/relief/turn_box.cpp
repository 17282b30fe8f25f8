// softfocus relief turn --box: the same turn by six faces, drawn once.

#include <algorithm>
#include <cstdio>

#include "raster/images/texel.h"
#include "raster/numbers/half.h"
#include "scenes/relief/relief_box.h"
#include "tools/cli/commands.h"
#include "tools/relief/turn_frames.h"

namespace softfocus {

int turn_box(const ReliefOptions& options) {
  const TurnPictures pictures = turn_pictures(options);
  const Scene scene = relief_scene(options);
  ThreadPool pool{options.pool.threads, options.pool.isa};
  const int width = options.size.width, height = options.size.height;
  ReliefMaker maker = prepare_relief(scene, options.frame, pool);
  PreparedScene prepared = prepare_scene(scene, Profile{}, pool);
  const Camera camera = turn_camera(scene, maker, options);
  const BoxForm form{std::max(options.texels.width, options.texels.height), options.depth_bits};
  ReliefBox box;
  const double made_ms = milliseconds_of([&] { box = draw_relief_box(maker, form, pool); });
  BoxMemory memory;

  const glm::vec4 clear = turn_background(scene, camera);
  const std::uint16_t background_depth = float_to_half(clear.w, HalfRounding::nearest_even);
  Image redrawn = make_image(Format::rgba16f, width, height);
  Image shown = make_image(Format::rgba16f, width, height);
  clear_image(shown, clear, Profile{});
  const Image blank = shown;
  prepared.depth = make_image(Format::r32f, width, height);
  TurnErrors errors;
  std::size_t unseen = 0, unhad = 0, most_bytes = 0;
  std::vector<double> redrawn_ms, shown_ms;
  for (int frame = 0; frame < options.frames; ++frame) {
    const CameraMatrices matrices = camera_matrices(camera, frame, width, height);
    const auto redraw = [&] {
      redraw_turned(prepared, matrices, options, scene.lights, clear, redrawn, pool);
    };
    if (frame == 0) redraw();  // warms up
    redrawn_ms.push_back(milliseconds_of(redraw));
    shown_ms.push_back(milliseconds_of([&] {
      clear_area(blank, {0, 0, width, height}, shown, pool);
      draw_box(box, matrices, warp_rule(options), memory, shown, pool);
    }));
    most_bytes = std::max(most_bytes, bytes_of(box) + bytes_of(memory));
    if (frame % options.every != 0) continue;
    measure_frame(redrawn, shown, background_depth, pool, errors);
    const float far_m = half_to_float(background_depth);
    for (const FacePoint had : unseen_pixels(box, matrices, redrawn, far_m, pool)) {
      unseen += had != FacePoint::by_seen ? 1 : 0;
      unhad += had == FacePoint::by_none ? 1 : 0;
    }
    write_pair(pictures, frame, redrawn, shown);
  }

  std::printf("%s: %zu triangles, %d frames of %dx%d; six faces: %.2f MB, drawn in %.1f ms\n",
              scene.name.c_str(), triangle_count(scene), options.frames, width, height,
              static_cast<double>(most_bytes) / 1e6, made_ms);
  const double redrawn_mean = mean_of(redrawn_ms), shown_mean = mean_of(shown_ms);
  std::printf("ms a frame: redrawn %.3f, box %.3f, ratio %.2f; medians: redrawn %.3f, box %.3f\n",
              redrawn_mean, shown_mean, redrawn_mean / shown_mean, sorted_at(redrawn_ms, 0.5),
              sorted_at(shown_ms, 0.5));
  print_errors(errors);
  std::printf("%zu show what no seen face has, %zu what no face has\n", unseen, unhad);
  return kDone;
}

}  // namespace softfocus

// softfocus relief turn --box: the same turn by six faces, drawn once.

#include <algorithm>
#include <cstdio>

#include "raster/numbers/half.h"
#include "scenes/relief/impostors/relief_box.h"
#include "tools/cli/commands.h"
#include "tools/relief/turn_frames.h"

namespace softfocus {

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

}  // namespace softfocus

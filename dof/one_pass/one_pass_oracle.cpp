// As a fragment shader would be written.

#include <algorithm>

#include "dof/one_pass/one_pass.h"
#include "dof/weights.h"
#include "raster/passes/fullscreen_pass.h"

namespace softfocus {

void one_pass_oracle(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  const ConstImageView& scene = input.scene;
  const auto fetch = [&](int x, int y) {
    return load_texel<Format::rgba16f>(scene, std::clamp(x, 0, scene.width - 1),
                                       std::clamp(y, 0, scene.height - 1));
  };
  const auto neighbour = [&](int x, int y) {
    const glm::vec4 texel = fetch(x, y);
    return filter_texel(input.settings, glm::vec3{texel.x, texel.y, texel.z}, texel.w);
  };
  const std::vector<RingTap> taps = ring_taps(input.settings.max_coc_px);
  fullscreen_pass<Format::rgba16f>(result, input.profile, pool, [&](int x, int y) {
    const FilterTexel centre = neighbour(x, y);
    const float receiver_leakage = leakage(centre.radius_px, input.settings.leak);
    Gather gather = begin_gather(centre);
    for (const RingTap& tap : taps) {
      add_neighbour(gather, neighbour(x + tap.dx, y + tap.dy), tap.distance_px, receiver_leakage);
    }
    return glm::vec4{resolve(gather), fetch(x, y).w};
  });
}

}  // namespace softfocus

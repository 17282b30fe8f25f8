#include <algorithm>

#include "dof/two_pass/two_pass.h"
#include "dof/weights.h"
#include "raster/passes/fullscreen_pass.h"

namespace softfocus {
namespace {

template <Format from, Format to>
void filter_along(const DofInput& input, const ConstImageView& source, const ImageView& target, int step_x, int step_y,
                  ThreadPool& pool) {
  const auto fetch = [&](int x, int y) {
    return load_texel<from>(source, std::clamp(x, 0, source.width - 1),
                            std::clamp(y, 0, source.height - 1));
  };
  const auto neighbour = [&](int x, int y) {
    const glm::vec4 texel = fetch(x, y);
    return filter_texel(input.settings, glm::vec3{texel.x, texel.y, texel.z}, texel.w);
  };
  fullscreen_pass<to>(target, input.profile, pool, [&](int x, int y) {
    const FilterTexel centre = neighbour(x, y);
    const float receiver_leakage = leakage(centre.radius_px, input.settings.leak);
    Gather gather = begin_gather(centre);
    for (int d = 1; d <= tap_count(input.settings.max_coc_px); ++d) {
      const auto distance = static_cast<float>(d);
      add_neighbour(gather, neighbour(x - d * step_x, y - d * step_y), distance, receiver_leakage);
      add_neighbour(gather, neighbour(x + d * step_x, y + d * step_y), distance, receiver_leakage);
    }
    return glm::vec4{resolve(gather), fetch(x, y).w};
  });
}

template <Format between_format>
void two_passes(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  Image between = make_image(between_format, input.scene.width, input.scene.height);
  filter_along<Format::rgba16f, between_format>(input, input.scene, between, 1, 0, pool);
  filter_along<between_format, Format::rgba16f>(input, between, result, 0, 1, pool);
}

}  // namespace

void two_pass_plain(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  two_passes<Format::rgba16f>(input, result, pool);
}

void two_pass_single_plain(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  two_passes<Format::rgba32f>(input, result, pool);
}

}  // namespace softfocus

#include "dof/show.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "raster/numbers/half.h"

namespace softfocus {
namespace {

template <class Grey>
Image grey_picture(const ConstImageView& scene, ThreadPool& pool, const Grey& grey_of_depth) {
  Image picture = make_image(Format::rgba16f, scene.width, scene.height);
  pool.for_each(scene.height, [&](int y) {
    const std::span<const std::uint16_t> from = row<std::uint16_t>(scene, y);
    const std::span<std::uint16_t> to = row<std::uint16_t>(picture, y);
    for (std::size_t i = 0; i < to.size(); i += 4) {
      const float depth = half_to_float(from[i + 3]);
      const float grey = std::clamp(grey_of_depth(depth), 0.0f, 1.0f);
      to[i] = to[i + 1] = to[i + 2] = float_to_half(grey, HalfRounding::nearest_even);
      to[i + 3] = float_to_half(depth, HalfRounding::nearest_even);
    }
  });
  return picture;
}

}  // namespace

Image show_coc(const ConstImageView& scene, const PixelCoc& coc, float max_coc_px,
               ThreadPool& pool) {
  return grey_picture(scene, pool, [&](float depth) {
    const float radius = std::fabs(coc_radius_px(coc, depth));
    return max_coc_px > 0.0f ? radius / max_coc_px : 0.0f;
  });
}

Image show_depth(const ConstImageView& scene, float near_m, float far_m, ThreadPool& pool) {
  const float at_near = 1.0f / near_m;
  const float at_far = 1.0f / far_m;
  return grey_picture(scene, pool,
                      [&](float depth) { return (at_near - 1.0f / depth) / (at_near - at_far); });
}

}  // namespace softfocus

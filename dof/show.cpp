#include "dof/show.h"

#include <algorithm>
#include <cmath>

#include "raster/images/texel.h"

namespace softfocus {
namespace {

template <class Grey>
Image grey_picture(const ConstImageView& scene, const Grey& grey_of_depth) {
  Image picture = make_image(Format::rgba16f, scene.width, scene.height);
  for (int y = 0; y < scene.height; ++y) {
    for (int x = 0; x < scene.width; ++x) {
      const float depth = load_texel<Format::rgba16f>(scene, x, y).w;
      const float grey = std::clamp(grey_of_depth(depth), 0.0f, 1.0f);
      store_texel<Format::rgba16f>(picture, x, y, {grey, grey, grey, depth}, {});
    }
  }
  return picture;
}

}  // namespace

Image show_coc(const ConstImageView& scene, const PixelCoc& coc, float max_coc_px) {
  return grey_picture(scene, [&](float depth) {
    const float radius = std::fabs(coc_radius_px(coc, depth));
    return max_coc_px > 0.0f ? radius / max_coc_px : 0.0f;
  });
}

Image show_depth(const ConstImageView& scene, float near_m, float far_m) {
  const float at_near = 1.0f / near_m;
  const float at_far = 1.0f / far_m;
  return grey_picture(scene,
                      [&](float depth) { return (at_near - 1.0f / depth) / (at_near - at_far); });
}

}  // namespace softfocus

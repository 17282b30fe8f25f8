#include "raster/images/mipmap.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "raster/images/texel.h"

namespace softfocus {

void generate_mipmaps(Texture& texture, const Profile& profile) {
  assert(!texture.levels.empty());
  texture.levels.resize(1);
  for (;;) {
    const Image& fine = texture.levels.back();
    if (fine.width == 1 && fine.height == 1) return;
    Image coarse =
        make_image(fine.format, std::max(1, fine.width / 2), std::max(1, fine.height / 2));
    for (int y = 0; y < coarse.height; ++y) {
      const int y0 = std::min(2 * y, fine.height - 1);
      const int y1 = std::min(2 * y + 1, fine.height - 1);
      for (int x = 0; x < coarse.width; ++x) {
        const int x0 = std::min(2 * x, fine.width - 1);
        const int x1 = std::min(2 * x + 1, fine.width - 1);
        const glm::vec4 sum = (load_texel(fine, x0, y0) + load_texel(fine, x1, y0)) +
                              (load_texel(fine, x0, y1) + load_texel(fine, x1, y1));
        store_texel(coarse, x, y, sum * 0.25f, profile);
      }
    }
    texture.levels.push_back(std::move(coarse));
  }
}

}  // namespace softfocus

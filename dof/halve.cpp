#include "dof/halve.h"

#include <algorithm>
#include <cassert>

#include "raster/images/texel.h"
#include "raster/threads/loops.h"

namespace softfocus {

Image halve(const Image& picture, const Profile& profile, ThreadPool& pool) {
  assert(picture.format == Format::rgba16f);
  assert(picture.width % 2 == 0 && picture.height % 2 == 0);
  constexpr int kRows = 8;  // that a thread takes at a time
  Image half = make_image(Format::rgba16f, picture.width / 2, picture.height / 2);
  for_each_row(pool, half.height, kRows, [&](int y) {
    for (int x = 0; x < half.width; ++x) {
      const auto texel = [&](int i, int j) {
        return load_texel<Format::rgba16f>(picture, 2 * x + i, 2 * y + j);
      };
      const glm::vec4 a = texel(0, 0), b = texel(1, 0), c = texel(0, 1), d = texel(1, 1);
      glm::vec4 mean = ((a + b) + (c + d)) * 0.25f;
      mean.w = std::min(std::min(a.w, b.w), std::min(c.w, d.w));
      store_texel<Format::rgba16f>(half, x, y, mean, profile);
    }
  });
  return half;
}

}  // namespace softfocus

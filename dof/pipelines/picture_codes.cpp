#include "dof/pipelines/picture_codes.h"

#include "raster/images/texel.h"

namespace softfocus {

Image codes_of(const ConstImageView& picture) {
  Image codes = make_image(Format::rgba8, picture.width, picture.height);
  for (int y = 0; y < picture.height; ++y) {
    const auto to = row<std::uint8_t>(codes, picture.height - 1 - y);
    for (int x = 0; x < picture.width; ++x) {
      const glm::vec4 texel = load_texel<Format::rgba16f>(picture, x, y);
      const auto at = static_cast<std::size_t>(4 * x);
      for (int c = 0; c < 3; ++c) to[at + static_cast<std::size_t>(c)] = linear_to_srgb8(texel[c]);
      to[at + 3] = 255;
    }
  }
  return codes;
}

void store_codes(const Image& codes, const ConstImageView& depths, const ImageView& result) {
  for (int y = 0; y < result.height; ++y) {
    for (int x = 0; x < result.width; ++x) {
      const glm::vec4 code = load_texel(codes, x, result.height - 1 - y);
      const auto light = [](float value) { return srgb8_to_linear(linear_to_unorm8(value)); };
      store_texel<Format::rgba16f>(result, x, y,
                                   {light(code.x), light(code.y), light(code.z),
                                    load_texel<Format::rgba16f>(depths, x, y).w},
                                   {});
    }
  }
}

}  // namespace softfocus

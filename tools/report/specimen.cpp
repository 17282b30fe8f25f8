#include "tools/report/specimen.h"

#include <bit>

#include "raster/images/texel.h"

namespace softfocus {

SpecimenPair specimen_pair() {
  constexpr int kWidth = 56, kHeight = 40;
  Image truth = make_image(Format::rgba16f, kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const float depth_m = x < 18 ? 1.0f : x < 36 ? 2.0f : 6.0f;
      const bool is_lamp = x % 13 == 5 && y % 11 == 4;
      const auto light = is_lamp ? 8.0f : static_cast<float>((3 * x + 5 * y) % 17) / 16.0f;
      const glm::vec4 texel{light, light / 2.0f, 1.0f - light / 8.0f, depth_m};
      store_texel<Format::rgba16f>(truth, x, y, texel, {});
    }
  }
  Image picture = with_wrong_pixels(truth);
  return {std::move(truth), std::move(picture)};
}

Image with_wrong_pixels(const Image& picture) {
  Image changed = picture;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const bool is_corner = 5 * x > 4 * picture.width && 4 * y < picture.height;
      const float factor = (x + 3 * y) % 5 == 0 ? 0.75f : is_corner ? 0.25f : 1.0f;
      const glm::vec4 texel = load_texel<Format::rgba16f>(picture, x, y);
      store_texel<Format::rgba16f>(changed, x, y, texel * glm::vec4{factor, factor, factor, 1.0f},
                                   {});
    }
  }
  return changed;
}

void add_number(Hash& hash, double number) {
  add_to_hash(hash, std::bit_cast<std::uint64_t>(number));
}

void add_text(Hash& hash, std::string_view text) {
  for (const char byte : text) add_to_hash(hash, static_cast<std::uint8_t>(byte));
}

}  // namespace softfocus

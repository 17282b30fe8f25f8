// A picture's colours in the sRGB curve and nothing else, as programs take them for a video.

#include "raster/images/texel.h"
#include "tools/pictures/image_file.h"
#include "tools/pictures/srgb16.h"

namespace softfocus {

Bytes encode_rgb24(const Image& image) {
  Bytes bytes;
  bytes.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 3);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const glm::vec4 colour = load_texel<Format::rgba16f>(image, x, y);
      for (int c = 0; c < 3; ++c) bytes.push_back(std::byte{linear_to_srgb8(colour[c])});
    }
  }
  return bytes;
}

Bytes encode_rgb48le(const Image& image) {
  const std::vector<std::uint16_t> encoded = srgb16_of_halves();
  Bytes bytes;
  bytes.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 6);
  for (int y = 0; y < image.height; ++y) {
    const auto halves = row<std::uint16_t>(image, y);
    for (std::size_t i = 0; i < halves.size(); ++i) {
      if (i % 4 == 3) continue;
      const std::uint16_t value = encoded[halves[i]];
      bytes.push_back(static_cast<std::byte>(value & 0xFF));
      bytes.push_back(static_cast<std::byte>(value >> 8));
    }
  }
  return bytes;
}

}  // namespace softfocus

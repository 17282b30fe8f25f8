#include "raster/images/texel.h"

namespace softfocus {

glm::vec4 load_texel(const Image& image, int x, int y) {
  switch (image.format) {
    case Format::r8: return load_texel<Format::r8>(image, x, y);
    case Format::rgba8: return load_texel<Format::rgba8>(image, x, y);
    case Format::srgb8: return load_texel<Format::srgb8>(image, x, y);
    case Format::rgba16f: return load_texel<Format::rgba16f>(image, x, y);
    case Format::r32f: return load_texel<Format::r32f>(image, x, y);
    case Format::rgba32f: return load_texel<Format::rgba32f>(image, x, y);
  }
  return {};
}

void store_texel(Image& image, int x, int y, glm::vec4 value, const Profile& profile) {
  switch (image.format) {
    case Format::r8: return store_texel<Format::r8>(image, x, y, value, profile);
    case Format::rgba8: return store_texel<Format::rgba8>(image, x, y, value, profile);
    case Format::srgb8: return store_texel<Format::srgb8>(image, x, y, value, profile);
    case Format::rgba16f: return store_texel<Format::rgba16f>(image, x, y, value, profile);
    case Format::r32f: return store_texel<Format::r32f>(image, x, y, value, profile);
    case Format::rgba32f: return store_texel<Format::rgba32f>(image, x, y, value, profile);
  }
}

void clear_image(Image& image, glm::vec4 value, const Profile& profile) {
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) store_texel(image, x, y, value, profile);
  }
}

}  // namespace softfocus

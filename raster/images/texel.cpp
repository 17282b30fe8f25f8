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

glm::vec4 fetch_texel(const Image& image, int x, int y, const Profile& profile) {
  const bool is_8_bit =
      bytes_per_texel(image.format) == static_cast<std::size_t>(channel_count(image.format));
  if (profile.texture_unit == TextureUnit::plain || !is_8_bit) return load_texel(image, x, y);
  const auto index =
      static_cast<std::size_t>(x) * static_cast<std::size_t>(channel_count(image.format));
  const std::uint8_t* v = &row<std::uint8_t>(image, y)[index];
  if (image.format == Format::r8) return {unorm8_by_reciprocal(v[0]), 0.0f, 0.0f, 1.0f};
  const auto decode = [&](std::uint8_t encoded) {
    if (image.format == Format::rgba8) return unorm8_by_reciprocal(encoded);
    return profile.texture_unit == TextureUnit::llvmpipe
               ? srgb8_to_linear_by_cubic(encoded, profile.lerp)
               : srgb8_to_linear_decimal(encoded);
  };
  return {decode(v[0]), decode(v[1]), decode(v[2]), unorm8_by_reciprocal(v[3])};
}

void clear_image(Image& image, glm::vec4 value, const Profile& profile) {
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) store_texel(image, x, y, value, profile);
  }
}

}  // namespace softfocus

#include "raster/images/texel.h"

#include <algorithm>
#include <cstring>

namespace softfocus {

glm::vec4 load_texel(const Image& image, int x, int y) {
  switch (image.format) {
    case Format::r8: return load_texel<Format::r8>(image, x, y);
    case Format::rgba8: return load_texel<Format::rgba8>(image, x, y);
    case Format::srgb8: return load_texel<Format::srgb8>(image, x, y);
    case Format::rgba16f: return load_texel<Format::rgba16f>(image, x, y);
    case Format::r32f: return load_texel<Format::r32f>(image, x, y);
    case Format::rgba32f: return load_texel<Format::rgba32f>(image, x, y);
    case Format::rg16f: return load_texel<Format::rg16f>(image, x, y);
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
    case Format::rg16f: return store_texel<Format::rg16f>(image, x, y, value, profile);
  }
}

glm::vec4 fetch_texel(const Image& image, int x, int y, const Profile& profile) {
  const bool is_8_bit =
      bytes_per_texel(image.format) == static_cast<std::size_t>(channel_count(image.format));
  if (profile.texture_unit == TextureUnit::standard || !is_8_bit) return load_texel(image, x, y);
  const auto index =
      static_cast<std::size_t>(x) * static_cast<std::size_t>(channel_count(image.format));
  const std::uint8_t* v = &row<std::uint8_t>(image, y)[index];
  if (image.format == Format::r8) return {unorm8_by_reciprocal(v[0]), 0.0f, 0.0f, 1.0f};
  const auto decode = [&](std::uint8_t encoded) {
    if (image.format == Format::rgba8) return unorm8_by_reciprocal(encoded);
    if (profile.texture_unit == TextureUnit::swiftshader) {
      return static_cast<float>(srgb8_in_65280ths(encoded)) * (1.0f / 65280.0f);
    }
    return profile.texture_unit == TextureUnit::llvmpipe
               ? srgb8_to_linear_by_cubic(encoded, profile.lerp)
               : srgb8_to_linear_decimal(encoded);
  };
  return {decode(v[0]), decode(v[1]), decode(v[2]), unorm8_by_reciprocal(v[3])};
}

void clear_image(Image& image, glm::vec4 value, const Profile& profile) {
  clear_image(image, 0, 0, image.width, image.height, value, profile);
}

void clear_image(Image& image, int x_begin, int y_begin, int x_end, int y_end, glm::vec4 value,
                 const Profile& profile) {
  store_texel(image, x_begin, y_begin, value, profile);
  const std::size_t texel = bytes_per_texel(image.format);
  const std::size_t bytes = static_cast<std::size_t>(x_end - x_begin) * texel;
  const auto start = [&](int y) {
    return image.bytes.data() + static_cast<std::size_t>(y) * image.stride_bytes +
           static_cast<std::size_t>(x_begin) * texel;
  };
  for (std::size_t done = texel; done < bytes; done *= 2) {
    std::memcpy(start(y_begin) + done, start(y_begin), std::min(done, bytes - done));
  }
  for (int y = y_begin + 1; y < y_end; ++y) std::memcpy(start(y), start(y_begin), bytes);
}

}  // namespace softfocus

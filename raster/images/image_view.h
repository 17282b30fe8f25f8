#pragma once
// Texel formats, and pictures that lie in somebody's memory: an Image's (image.h), or a
// caller's own.

#include <cstddef>
#include <cstdint>
#include <span>

namespace softfocus {

enum class Format : std::uint8_t {
  r8,       ///< 1 x 8-bit unsigned normalised; also the stencil's
  rgba8,    ///< 4 x 8-bit unsigned normalised, linear
  srgb8,    ///< 3 x 8-bit sRGB and a linear alpha
  rgba16f,  ///< 4 x binary16
  r32f,     ///< 1 x binary32; also the depth buffer's
  rgba32f,  ///< 4 x binary32
  rg16f,    ///< 2 x binary16: a motion in pixels
};

constexpr int channel_count(Format format) {
  if (format == Format::rg16f) return 2;
  return format == Format::r8 || format == Format::r32f ? 1 : 4;
}

constexpr std::size_t bytes_per_texel(Format format) {
  switch (format) {
    case Format::r8: return 1;
    case Format::rgba8: return 4;
    case Format::srgb8: return 4;
    case Format::rgba16f: return 8;
    case Format::r32f: return 4;
    case Format::rgba32f: return 16;
    case Format::rg16f: return 4;
  }
  return 0;
}

inline constexpr std::size_t kTexelHalves = 4;  ///< of Format::rgba16f

/// Largest width and height of a picture: what GPUs of the time allow (D3D11: 16384).
inline constexpr int kMaxImageSize = 16384;

/// Texels to read: `height` rows of `width` texels, row 0 on top, from one row to the next
/// `stride_bytes`, which may be negative. Rows are aligned to their channels' type. Where
/// the first row and the stride are multiples of 64 bytes, filters may be faster.
struct ConstImageView {
  Format format = Format::rgba16f;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride_bytes = 0;
  const std::byte* texels = nullptr;  ///< of row 0
};

/// Texels to write.
struct ImageView {
  Format format = Format::rgba16f;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride_bytes = 0;
  std::byte* texels = nullptr;

  operator ConstImageView() const {  // NOLINT(google-explicit-constructor)
    return {format, width, height, stride_bytes, texels};
  }
};

/// A picture in rows one after the other, or `stride_bytes` apart.
inline ImageView view_of(Format format, void* texels, int width, int height,
                         std::ptrdiff_t stride_bytes = 0) {
  const auto row_bytes = static_cast<std::ptrdiff_t>(bytes_per_texel(format)) * width;
  return {format, width, height, stride_bytes != 0 ? stride_bytes : row_bytes,
          static_cast<std::byte*>(texels)};
}

/// Row `y` as its channels' storage type (uint8_t, uint16_t or float): width times
/// channel_count values. Needs the type that the format has.
template <class Channel>
std::span<Channel> row(const ImageView& image, int y) {
  return {reinterpret_cast<Channel*>(image.texels + y * image.stride_bytes),
          static_cast<std::size_t>(image.width) *
              static_cast<std::size_t>(channel_count(image.format))};
}
template <class Channel>
std::span<const Channel> row(const ConstImageView& image, int y) {
  return {reinterpret_cast<const Channel*>(image.texels + y * image.stride_bytes),
          static_cast<std::size_t>(image.width) *
              static_cast<std::size_t>(channel_count(image.format))};
}

}  // namespace softfocus

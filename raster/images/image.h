#pragma once
// An image: texels of one format in rows, row 0 on top. Rows begin on 64-byte
// boundaries, so that vector code can read and write whole lines.

#include <cstddef>
#include <cstdint>
#include <new>
#include <span>
#include <vector>

namespace softfocus {

enum class Format : std::uint8_t {
  r8,       ///< 1 x 8-bit unsigned normalised; also the stencil's
  rgba8,    ///< 4 x 8-bit unsigned normalised, linear
  srgb8,    ///< 3 x 8-bit sRGB and a linear alpha
  rgba16f,  ///< 4 x binary16
  r32f,     ///< 1 x binary32; also the depth buffer's
  rgba32f,  ///< 4 x binary32
};

constexpr int channel_count(Format format) {
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
  }
  return 0;
}

/// Largest width and height of an image: what GPUs of the time allow (D3D11: 16384).
inline constexpr int kMaxImageSize = 16384;
inline constexpr std::size_t kRowAlignment = 64;

template <class T>
struct RowAllocator {
  using value_type = T;
  RowAllocator() = default;
  template <class U>
  RowAllocator(const RowAllocator<U>&) {}  // NOLINT(google-explicit-constructor)
  T* allocate(std::size_t count) {
    return static_cast<T*>(::operator new (count * sizeof(T), std::align_val_t{kRowAlignment}));
  }
  void deallocate(T* memory, std::size_t) {
    ::operator delete (memory, std::align_val_t{kRowAlignment});
  }
  bool operator==(const RowAllocator&) const = default;
};

struct Image {
  Format format = Format::rgba16f;
  int width = 0;
  int height = 0;
  std::size_t stride_bytes = 0;  ///< from one row to the next, a multiple of 64
  std::vector<std::byte, RowAllocator<std::byte>> bytes;
};

/// An image of zeros. Needs 1 <= width, height <= kMaxImageSize.
Image make_image(Format format, int width, int height);

/// Row `y` as its channels' storage type (uint8_t, uint16_t or float): width times
/// channel_count values. Needs the type that the format has.
template <class Channel>
std::span<Channel> row(Image& image, int y) {
  auto* start = image.bytes.data() + static_cast<std::size_t>(y) * image.stride_bytes;
  return {reinterpret_cast<Channel*>(start),
          static_cast<std::size_t>(image.width) *
              static_cast<std::size_t>(channel_count(image.format))};
}
template <class Channel>
std::span<const Channel> row(const Image& image, int y) {
  const auto* start = image.bytes.data() + static_cast<std::size_t>(y) * image.stride_bytes;
  return {reinterpret_cast<const Channel*>(start),
          static_cast<std::size_t>(image.width) *
              static_cast<std::size_t>(channel_count(image.format))};
}

/// FNV-1a of the size, the format and every texel's bits, row by row; padding is left out.
std::uint64_t hash_image(const Image& image);

/// Same format, size and bits.
bool equal(const Image& a, const Image& b);

}  // namespace softfocus

#include "raster/images/image.h"

#include <algorithm>
#include <cassert>
#include <cstring>

namespace softfocus {

RowBytes::RowBytes(std::size_t size) {
  std::size_t room = size + kRowAlignment;
  void* memory = std::calloc(room, 1);
  if (memory == nullptr) throw std::bad_alloc();
  prefer_large_pages(memory, room);
  void* first = memory;
  std::align(kRowAlignment, size, first, room);
  bytes_ = {static_cast<std::byte*>(first), Free{memory, size}};
}

RowBytes::RowBytes(const RowBytes& other) : RowBytes(other.size()) {
  std::copy(other.begin(), other.end(), begin());
}

bool RowBytes::operator==(const RowBytes& other) const {
  return std::equal(begin(), end(), other.begin(), other.end());
}

Image make_image(Format format, int width, int height) {
  assert(width >= 1 && width <= kMaxImageSize && height >= 1 && height <= kMaxImageSize);
  Image image{.format = format, .width = width, .height = height, .stride_bytes = 0, .bytes = {}};
  const std::size_t used = static_cast<std::size_t>(width) * bytes_per_texel(format);
  image.stride_bytes = (used + kRowAlignment - 1) / kRowAlignment * kRowAlignment;
  image.bytes = RowBytes{image.stride_bytes * static_cast<std::size_t>(height)};
  return image;
}

namespace {

template <class Channel>
void add_channels_to_hash(Hash& hash, const ConstImageView& image) {
  for (int y = 0; y < image.height; ++y) {
    for (const Channel value : row<Channel>(image, y)) add_to_hash(hash, value);
  }
}

}  // namespace

Hash begin_image_hash(Format format, int width, int height) {
  Hash hash;
  add_to_hash(hash, static_cast<std::uint8_t>(format));
  add_to_hash(hash, static_cast<std::uint32_t>(width));
  add_to_hash(hash, static_cast<std::uint32_t>(height));
  return hash;
}

void add_rows_to_hash(Hash& hash, const ConstImageView& rows) {
  switch (rows.format) {
    case Format::r8:
    case Format::rgba8:
    case Format::srgb8: add_channels_to_hash<std::uint8_t>(hash, rows); break;
    case Format::rg16f:
    case Format::rgba16f: add_channels_to_hash<std::uint16_t>(hash, rows); break;
    case Format::r32f:
    case Format::rgba32f: add_channels_to_hash<float>(hash, rows); break;
  }
}

std::uint64_t hash_image(const ConstImageView& image) {
  Hash hash = begin_image_hash(image.format, image.width, image.height);
  add_rows_to_hash(hash, image);
  return hash.value;
}

bool equal(const ConstImageView& a, const ConstImageView& b) {
  if (a.format != b.format || a.width != b.width || a.height != b.height) return false;
  const std::size_t used = static_cast<std::size_t>(a.width) * bytes_per_texel(a.format);
  for (int y = 0; y < a.height; ++y) {
    if (std::memcmp(a.texels + y * a.stride_bytes, b.texels + y * b.stride_bytes, used) != 0) {
      return false;
    }
  }
  return true;
}

}  // namespace softfocus

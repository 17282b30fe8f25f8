// PNG through stb: the writer is compiled here, the reader in scenes/.

#include <stb_image.h>

#include <array>
#include <cstdlib>
#include <memory>
#include <new>

#include "raster/images/texel.h"
#include "tools/cli/errors.h"
#include "tools/files/byte_order.h"
#include "tools/files/image_file.h"

namespace {

/// stb only asserts that its buffer could grow, but no memory is an error like any other.
void* grown(void* memory, std::size_t size) {
  void* larger = std::realloc(memory, size);
  if (larger == nullptr) throw std::bad_alloc{};
  return larger;
}

}  // namespace
#define STBIW_MALLOC(size) std::malloc(size)
#define STBIW_REALLOC(memory, size) grown(memory, size)
#define STBIW_FREE(memory) std::free(memory)

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#endif
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#include <stb_image_write.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

namespace softfocus {
namespace {

/// CRC-32 of ISO 3309, as the PNG specification's annex D gives it.
std::uint32_t crc32(std::span<const std::byte> bytes) {
  std::uint32_t crc = 0xFFFFFFFFu;
  for (const std::byte byte : bytes) {
    crc ^= std::to_integer<std::uint32_t>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1u) != 0 ? 0xEDB88320u ^ crc >> 1 : crc >> 1;
  }
  return ~crc;
}

/// Goes through the chunks, which stb reads without their checksums and, once it has
/// its pixels, without minding the end.
void check_chunks(std::span<const std::byte> bytes) {
  constexpr std::size_t kSignature = 8, kFrame = 12;  // a chunk: length, type, data, CRC
  constexpr std::uint32_t kIend = 0x49454E44;
  const FileError truncated{"the PNG is cut short"};
  if (bytes.size() < kSignature) throw truncated;
  for (auto rest = bytes.subspan(kSignature);;) {
    if (rest.size() < kFrame) throw truncated;
    const std::size_t length = big_endian<std::uint32_t>(rest);
    if (rest.size() - kFrame < length) throw truncated;
    const auto type_and_data = rest.subspan(4, 4 + length);
    if (crc32(type_and_data) != big_endian<std::uint32_t>(rest.subspan(8 + length))) {
      throw FileError("the PNG is damaged: a checksum is wrong");
    }
    rest = rest.subspan(kFrame + length);
    if (big_endian<std::uint32_t>(type_and_data) != kIend) continue;
    if (!rest.empty()) throw FileError("the PNG goes on after its end");
    return;
  }
}

}  // namespace

Bytes encode_png(const Image& image) {
  std::vector<std::uint8_t> rgb;
  rgb.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 3);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const glm::vec4 colour = load_texel<Format::rgba16f>(image, x, y);
      for (int c = 0; c < 3; ++c) rgb.push_back(linear_to_srgb8(colour[c]));
    }
  }
  int size = 0;
  const std::unique_ptr<unsigned char, decltype(&std::free)> png{
      stbi_write_png_to_mem(rgb.data(), 3 * image.width, image.width, image.height, 3, &size),
      std::free};
  if (!png) throw std::bad_alloc{};
  const auto* start = reinterpret_cast<const std::byte*>(png.get());
  return {start, start + size};
}

Picture decode_png(std::span<const std::byte> bytes) {
  check_chunks(bytes);
  if (bytes.size() > 0x7FFFFFFF) throw FileError("the PNG is larger than 2 GB");
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int data_size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  if (stbi_info_from_memory(data, data_size, &width, &height, &channels) == 0) {
    throw FileError(std::string{"the PNG is damaged: "} + stbi_failure_reason());
  }
  if (width < 1 || height < 1 || width > kMaxImageSize || height > kMaxImageSize) {
    throw FileError("the PNG is " + std::to_string(width) + "x" + std::to_string(height) +
                    " pixels; each side may be 1 to " + std::to_string(kMaxImageSize));
  }
  if (stbi_is_16_bit_from_memory(data, data_size) != 0) {
    throw FileError("the PNG has 16 bits a channel; 8 are supported");
  }
  const bool has_alpha = channels == 2 || channels == 4;
  const std::unique_ptr<stbi_uc, decltype(&stbi_image_free)> texels{
      stbi_load_from_memory(data, data_size, &width, &height, &channels, 4), stbi_image_free};
  if (!texels) throw FileError(std::string{"the PNG is damaged: "} + stbi_failure_reason());

  Picture picture{make_image(Format::rgba16f, width, height), has_alpha};
  // Half of linear light is 2^-11 of the value fine and the table's steps are coarser.
  std::array<std::uint16_t, 256> half_of{}, half_of_alpha{};
  for (std::size_t i = 0; i < 256; ++i) {
    const auto encoded = static_cast<std::uint8_t>(i);
    half_of[i] = float_to_half(srgb8_to_linear(encoded), HalfRounding::nearest_even);
    half_of_alpha[i] = float_to_half(unorm8_to_linear(encoded), HalfRounding::nearest_even);
  }
  const stbi_uc* texel = texels.get();
  for (int y = 0; y < height; ++y) {
    const auto values = row<std::uint16_t>(picture.image, y);
    for (std::size_t i = 0; i < values.size(); i += 4, texel += 4) {
      for (std::size_t c = 0; c < 3; ++c) values[i + c] = half_of[texel[c]];
      values[i + 3] = has_alpha ? half_of_alpha[texel[3]] : std::uint16_t{0};
    }
  }
  return picture;
}

}  // namespace softfocus

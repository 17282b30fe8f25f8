// PNG through stb: the writer is compiled here, the reader in scenes/.

#include <stb_image.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "raster/images/texel.h"
#include "tools/cli/errors.h"
#include "tools/pictures/image_file.h"
#include "tools/pictures/png_text.h"

namespace {

/// stb only asserts that its buffer could grow, but no memory is an error like any other.
void* grown(void* memory, std::size_t size) {
  void* larger = std::realloc(memory, size);
  if (larger == nullptr) throw std::bad_alloc{};
  return larger;
}

/// Systems differ in malloc(0).
void* allocated(std::size_t size) { return std::malloc(size > 0 ? size : 1); }

}  // namespace
#define STBIW_MALLOC(size) allocated(static_cast<std::size_t>(size))
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

/// A colour that was multiplied by `alpha`, as it was before.
float divided(float colour, float alpha) { return alpha > 0.0f ? colour / alpha : 0.0f; }

/// 0 to `full` for 0 to 1.
float code_of_share(float alpha, float full) {
  return alpha > 0.0f ? std::min(alpha, 1.0f) * full + 0.5f : 0.0f;
}

}  // namespace

Bytes encode_png(const Image& image, std::span<const float> alpha) {
  const int channels = alpha.empty() ? 3 : 4;
  std::vector<std::uint8_t> values;
  values.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) *
                 static_cast<std::size_t>(channels));
  std::size_t pixel = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x, ++pixel) {
      const glm::vec4 colour = load_texel<Format::rgba16f>(image, x, y);
      for (int c = 0; c < 3; ++c) {
        values.push_back(
            linear_to_srgb8(alpha.empty() ? colour[c] : divided(colour[c], alpha[pixel])));
      }
      if (!alpha.empty()) {
        values.push_back(static_cast<std::uint8_t>(code_of_share(alpha[pixel], 255.0f)));
      }
    }
  }
  int size = 0;
  const std::unique_ptr<unsigned char, decltype(&std::free)> png{
      stbi_write_png_to_mem(values.data(), channels * image.width, image.width, image.height,
                            channels, &size),
      std::free};
  if (!png) throw std::bad_alloc{};
  const auto* start = reinterpret_cast<const std::byte*>(png.get());
  return {start, start + size};
}

namespace {

/// Rows of 16-bit numbers, high bytes first, each behind its filter's number: Sub, the difference
/// from the pixel on the left.
Bytes png_of_wide_rows(std::span<const std::uint16_t> values, int width, int height,
                       std::size_t channels) {
  const std::size_t row_values = static_cast<std::size_t>(width) * channels;
  if (values.size() * 2 + static_cast<std::size_t>(height) > 0x7FFFFFFF) {
    throw FileError("a PNG of 16 bits can have 2 GB of values at most; write an EXR");
  }
  constexpr std::uint8_t kSub = 1;
  std::vector<std::uint8_t> rows;
  rows.reserve(values.size() * 2 + static_cast<std::size_t>(height));
  for (std::size_t start = 0; start < values.size(); start += row_values) {
    rows.push_back(kSub);
    for (std::size_t i = 0; i < row_values; ++i) {
      const std::uint16_t value = values[start + i];
      const std::uint16_t left = i < channels ? std::uint16_t{0} : values[start + i - channels];
      rows.push_back(static_cast<std::uint8_t>((value >> 8) - (left >> 8)));
      rows.push_back(static_cast<std::uint8_t>((value & 0xFF) - (left & 0xFF)));
    }
  }
  constexpr int kQuality = 8;  // stb's own for PNG
  int size = 0;
  const std::unique_ptr<unsigned char, decltype(&std::free)> packed{
      stbi_zlib_compress(rows.data(), static_cast<int>(rows.size()), &size, kQuality), std::free};
  if (!packed) throw std::bad_alloc{};

  std::string header;
  for (const int side : {width, height}) {
    for (int shift = 24; shift >= 0; shift -= 8) header += static_cast<char>(side >> shift & 0xFF);
  }
  header += static_cast<char>(16);                                         // bits
  header += static_cast<char>(channels == 1 ? 0 : channels == 3 ? 2 : 6);  // grey, RGB or RGBA
  header += std::string(3, '\0');  // the one compression, filter, no interlace
  Bytes bytes;
  for (const char c : kPngSignature) bytes.push_back(static_cast<std::byte>(c));
  append_png_chunk(bytes, "IHDR", header);
  append_png_chunk(bytes, "IDAT",
                   {reinterpret_cast<const char*>(packed.get()), static_cast<std::size_t>(size)});
  append_png_chunk(bytes, "IEND", {});
  return bytes;
}

}  // namespace

Bytes with_png_profile(std::span<const std::byte> png, std::span<const std::byte> icc) {
  constexpr int kQuality = 8;  // stb's own for PNG
  constexpr std::ptrdiff_t kHeaderEnd = 8 + 25;
  std::vector<std::uint8_t> plain(icc.size());
  std::memcpy(plain.data(), icc.data(), icc.size());
  int size = 0;
  const std::unique_ptr<unsigned char, decltype(&std::free)> packed{
      stbi_zlib_compress(plain.data(), static_cast<int>(plain.size()), &size, kQuality), std::free};
  if (!packed) throw std::bad_alloc{};
  std::string data = "ICC profile";
  data.append(2, '\0');  // ends the name; the one compression
  data.append(reinterpret_cast<const char*>(packed.get()), static_cast<std::size_t>(size));
  Bytes bytes{png.begin(), png.begin() + kHeaderEnd};
  append_png_chunk(bytes, "iCCP", data);
  bytes.insert(bytes.end(), png.begin() + kHeaderEnd, png.end());
  return bytes;
}

std::vector<std::uint16_t> srgb16_values(const Image& image, std::span<const float> alpha) {
  const std::vector<std::uint16_t> encoded = srgb16_of_halves();
  const std::size_t channels = alpha.empty() ? 3 : 4;
  std::vector<std::uint16_t> values;
  values.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) *
                 channels);
  std::size_t pixel = 0;
  for (int y = 0; y < image.height; ++y) {
    const auto halves = row<std::uint16_t>(image, y);
    for (std::size_t i = 0; i < halves.size(); i += 4, ++pixel) {
      for (std::size_t c = 0; c < 3; ++c) {
        const std::uint16_t half =
            alpha.empty() ? halves[i + c]
                          : float_to_half(divided(half_to_float(halves[i + c]), alpha[pixel]),
                                          HalfRounding::nearest_even);
        values.push_back(encoded[half]);
      }
      if (!alpha.empty()) {
        values.push_back(static_cast<std::uint16_t>(code_of_share(alpha[pixel], 65535.0f)));
      }
    }
  }
  return values;
}

Bytes encode_png_16(const Image& image, std::span<const float> alpha) {
  return png_of_wide_rows(srgb16_values(image, alpha), image.width, image.height,
                          alpha.empty() ? 3 : 4);
}

Bytes encode_grey_png_16(std::span<const std::uint16_t> values, int width, int height) {
  return png_of_wide_rows(values, width, height, 1);
}

Picture decode_png(std::span<const std::byte> bytes) {
  check_png_chunks(bytes);  // stb reads them without checksums, and does not mind the end
  if (bytes.size() > 0x7FFFFFFF) throw FileError("the PNG is larger than 2 GB");
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int data_size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  if (stbi_info_from_memory(data, data_size, &width, &height, &channels) == 0) {
    throw FileError(std::string{"the PNG is damaged: "} + stbi_failure_reason());
  }
  if (stbi_is_16_bit_from_memory(data, data_size) != 0) return decode_other(bytes, "the PNG");
  const bool has_alpha = channels == 2 || channels == 4 || has_transparent_colour(bytes);
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

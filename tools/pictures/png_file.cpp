// PNG: written here, compressed by libdeflate or stb. stb's reader is compiled in scenes/.

#include <stb_image.h>
#ifdef SOFTFOCUS_WITH_LIBDEFLATE
#include <libdeflate.h>
#endif

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "raster/images/texel.h"
#include "raster/threads/loops.h"
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

#ifdef SOFTFOCUS_WITH_LIBDEFLATE
namespace {

/// In place of stb's compressor: files are a quarter smaller. One call for the whole, as
/// libdeflate's pieces do not join.
unsigned char* deflated(const unsigned char* data, int size, int* packed_size, int) {
  constexpr int kLevel = 1;
  const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor{
      libdeflate_alloc_compressor(kLevel), libdeflate_free_compressor};
  if (!compressor) throw std::bad_alloc{};
  const auto count = static_cast<std::size_t>(size);
  const std::size_t most = libdeflate_zlib_compress_bound(compressor.get(), count);
  auto* packed = static_cast<unsigned char*>(grown(nullptr, most));
  *packed_size =
      static_cast<int>(libdeflate_zlib_compress(compressor.get(), data, count, packed, most));
  return packed;
}

}  // namespace
#define STBIW_ZLIB_COMPRESS deflated
#endif

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

/// Compresses. For PNG stb's own quality is 8.
std::string packed_text(std::vector<std::uint8_t>& plain) {
  constexpr int kQuality = 8;
  int size = 0;
  const std::unique_ptr<unsigned char, decltype(&std::free)> packed{
      stbi_zlib_compress(plain.data(), static_cast<int>(plain.size()), &size, kQuality), std::free};
  if (!packed) throw std::bad_alloc{};
  return {reinterpret_cast<const char*>(packed.get()), static_cast<std::size_t>(size)};
}

/// A PNG of rows, each behind its filter's number.
Bytes png_of_rows(std::vector<std::uint8_t>& rows, int width, int height, int bits,
                  std::size_t channels) {
  std::string header;
  for (const int side : {width, height}) {
    for (int shift = 24; shift >= 0; shift -= 8) header += static_cast<char>(side >> shift & 0xFF);
  }
  header += static_cast<char>(bits);
  header += static_cast<char>(channels == 1 ? 0 : channels == 3 ? 2 : 6);  // grey, RGB or RGBA
  header += std::string(3, '\0');  // the one compression, filter, no interlace
  Bytes bytes;
  for (const char c : kPngSignature) bytes.push_back(static_cast<std::byte>(c));
  append_png_chunk(bytes, "IHDR", header);
  append_png_chunk(bytes, "IDAT", packed_text(rows));
  append_png_chunk(bytes, "IEND", {});
  return bytes;
}

void check_png_size(std::size_t bytes) {
  // Compressors count in int, and noise grows a little.
  if (bytes > 0x7F000000) throw FileError("a PNG can have 2 GB of values at most; write an EXR");
}

constexpr std::size_t kWords = 8;  // of 16 bytes, which every CPU has
using Words [[gnu::vector_size(2 * kWords)]] = std::int16_t;
using WordBytes [[gnu::vector_size(kWords)]] = std::uint8_t;

Words load_words(const std::uint8_t* from) {
  WordBytes bytes;
  std::memcpy(&bytes, from, sizeof bytes);
  return __builtin_convertvector(bytes, Words);
}

/// PNG's filter 4: differences from the value on the left, above or above on the left that is
/// nearest to left + above - that. Reads, and writes, up to a whole vector; needs `channels` values
/// before the rows.
void filter_by_paeth(const std::uint8_t* row, const std::uint8_t* above, std::size_t count,
                     std::size_t channels, std::uint8_t* to) {
  for (std::size_t i = 0; i < count; i += kWords) {
    const Words a = load_words(row + i - channels);
    const Words b = load_words(above + i);
    const Words c = load_words(above + i - channels);
    const auto magnitude = [](Words v) { return v < 0 ? -v : v; };
    const Words to_a = magnitude(b - c), to_b = magnitude(a - c), to_c = magnitude(a + b - 2 * c);
    const Words nearest = ((to_a <= to_b) & (to_a <= to_c)) ? a : to_b <= to_c ? b : c;
    const WordBytes difference = __builtin_convertvector(load_words(row + i) - nearest, WordBytes);
    std::memcpy(to + i, &difference, sizeof difference);
  }
}

/// A row of 8-bit values.
void encode_row(const Image& image, int y, std::span<const float> alpha, std::uint8_t* to) {
  const auto& encoded = srgb8_of_halves();
  const auto halves = row<std::uint16_t>(image, y);
  if (alpha.empty()) {
    for (std::size_t i = 0; i < halves.size(); i += 4) {
      for (std::size_t c = 0; c < 3; ++c) *to++ = encoded[halves[i + c]];
    }
    return;
  }
  const float* share = &alpha[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width)];
  for (std::size_t i = 0; i < halves.size(); i += 4, ++share) {
    for (std::size_t c = 0; c < 3; ++c) {
      *to++ = linear_to_srgb8(divided(half_to_float(halves[i + c]), *share));
    }
    *to++ = static_cast<std::uint8_t>(code_of_share(*share, 255.0f));
  }
}

}  // namespace

Bytes encode_png(const Image& image, std::span<const float> alpha, ThreadPool* pool) {
  if (pool == nullptr) {
    ThreadPool here{1};
    return encode_png(image, alpha, &here);
  }
  constexpr std::uint8_t kPaeth = 4;
  constexpr int kFilteredRows = 32;
  const std::size_t channels = alpha.empty() ? 3 : 4;
  const std::size_t count = static_cast<std::size_t>(image.width) * channels;
  const auto height = static_cast<std::size_t>(image.height);
  check_png_size((count + 1) * height);
  std::vector<std::uint8_t> rows((count + 1) * height);
  struct Band {
    std::vector<std::uint8_t> values, above, filtered;
  };
  for_each_band_with<Band>(*pool, image.height, kFilteredRows, [&](int first, int end, Band& band) {
    band.values.assign(channels + count + kWords, 0);
    band.above.assign(channels + count + kWords, 0);
    band.filtered.resize(count + kWords);
    if (first > 0) encode_row(image, first - 1, alpha, band.above.data() + channels);
    for (int y = first; y < end; ++y) {
      encode_row(image, y, alpha, band.values.data() + channels);
      filter_by_paeth(band.values.data() + channels, band.above.data() + channels, count, channels,
                      band.filtered.data());
      std::uint8_t* const to = rows.data() + static_cast<std::size_t>(y) * (count + 1);
      *to = kPaeth;
      std::memcpy(to + 1, band.filtered.data(), count);
      std::swap(band.values, band.above);
    }
  });
  return png_of_rows(rows, image.width, image.height, 8, channels);
}

namespace {

/// Rows of 16-bit numbers, high bytes first, filtered by Sub: the difference from the pixel on the
/// left.
Bytes png_of_wide_rows(std::span<const std::uint16_t> values, int width, int height,
                       std::size_t channels) {
  const std::size_t row_values = static_cast<std::size_t>(width) * channels;
  check_png_size(values.size() * 2 + static_cast<std::size_t>(height));
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
  return png_of_rows(rows, width, height, 16, channels);
}

}  // namespace

Bytes with_png_profile(std::span<const std::byte> png, std::span<const std::byte> icc) {
  constexpr std::ptrdiff_t kHeaderEnd = 8 + 25;
  std::vector<std::uint8_t> plain(icc.size());
  std::memcpy(plain.data(), icc.data(), icc.size());
  std::string data = "ICC profile";
  data.append(2, '\0');  // ends the name; the one compression
  data.append(packed_text(plain));
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

// Portable float map (Paul Debevec's): three lines of text, then binary32 rows, the
// lowest first. A negative scale says little-endian; its size says nothing here.

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <string>

#include "raster/images/texel.h"
#include "scenes/load/decimal.h"
#include "tools/cli/errors.h"
#include "tools/files/byte_order.h"
#include "tools/files/image_file.h"

namespace softfocus {
namespace {

constexpr std::size_t kTexelBytes = 3 * sizeof(float);

/// Takes the next word of the header and the one white space behind it.
std::string_view take_word(std::span<const std::byte>& rest) {
  const auto is_space = [](std::byte b) {
    return b == std::byte{' '} || b == std::byte{'\n'} || b == std::byte{'\r'} ||
           b == std::byte{'\t'};
  };
  constexpr std::size_t kLongestWord = 32;
  const auto limit = rest.first(std::min(rest.size(), kLongestWord));
  const auto end = std::find_if(limit.begin(), limit.end(), is_space);
  if (end == limit.end()) throw FileError("the PFM's header is cut short or is not one");
  const auto length = static_cast<std::size_t>(end - limit.begin());
  const std::string_view word{reinterpret_cast<const char*>(rest.data()), length};
  rest = rest.subspan(length + 1);
  return word;
}

[[noreturn]] void refuse_number(std::string_view word) {
  throw FileError("the PFM's header has '" + std::string{word} + "' where a number belongs");
}

int whole_number(std::string_view word) {
  int value = 0;
  const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || stop != word.data() + word.size()) refuse_number(word);
  return value;
}

float number(std::string_view word) {
  const auto value = decimal_to_float(word);
  if (!value) refuse_number(word);
  return *value;
}

}  // namespace

Bytes encode_pfm(const Image& image) {
  const std::string header =
      "PF\n" + std::to_string(image.width) + " " + std::to_string(image.height) + "\n-1.0\n";
  Bytes bytes;
  bytes.reserve(header.size() + kTexelBytes * static_cast<std::size_t>(image.width) *
                                    static_cast<std::size_t>(image.height));
  for (const char c : header) bytes.push_back(static_cast<std::byte>(c));
  for (int y = image.height - 1; y >= 0; --y) {
    for (int x = 0; x < image.width; ++x) {
      const glm::vec4 colour = load_texel<Format::rgba16f>(image, x, y);
      for (int c = 0; c < 3; ++c) {
        append_little_endian(bytes, std::bit_cast<std::uint32_t>(colour[c]));
      }
    }
  }
  return bytes;
}

Picture decode_pfm(std::span<const std::byte> bytes) {
  auto rest = bytes;
  if (take_word(rest) != "PF") throw FileError("the PFM must be a colour one, 'PF'");
  const int width = whole_number(take_word(rest));
  const int height = whole_number(take_word(rest));
  const float scale = number(take_word(rest));
  if (width < 1 || height < 1 || width > kMaxImageSize || height > kMaxImageSize) {
    throw FileError("the PFM is " + std::to_string(width) + "x" + std::to_string(height) +
                    " pixels; each side may be 1 to " + std::to_string(kMaxImageSize));
  }
  if (!std::isfinite(scale) || scale == 0.0f) {
    throw FileError("the PFM's scale must be a number below or above 0");
  }
  const auto size =
      kTexelBytes * static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  if (rest.size() != size) {
    throw FileError("the PFM has " + std::to_string(rest.size()) +
                    " bytes of values where its size needs " + std::to_string(size));
  }
  Picture picture{make_image(Format::rgba16f, width, height), false};
  for (int y = height - 1; y >= 0; --y) {
    const auto values = row<std::uint16_t>(picture.image, y);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (i % 4 == 3) continue;
      const auto bits =
          scale < 0.0f ? little_endian<std::uint32_t>(rest) : big_endian<std::uint32_t>(rest);
      values[i] = float_to_half(std::bit_cast<float>(bits), HalfRounding::nearest_even);
      rest = rest.subspan(sizeof bits);
    }
  }
  return picture;
}

}  // namespace softfocus

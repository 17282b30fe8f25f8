// NumPy's array file: a magic word, a version, the length of the header, the header,
// which is a Python dict literal padded with blanks, and the values.
// numpy/lib/format.py describes it.

#include <algorithm>
#include <bit>
#include <charconv>
#include <string>

#include "raster/images/image.h"
#include "raster/numbers/half.h"
#include "tools/cli/errors.h"
#include "tools/files/byte_order.h"
#include "tools/files/image_file.h"

namespace softfocus {
namespace {

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr std::size_t kAlignment = 64;  // of the values in the file

struct Header {
  std::string type;
  bool columns_first = false;
  std::vector<std::uint64_t> shape;
};

/// Reads as much of Python as the header may hold.
class HeaderReader {
 public:
  explicit HeaderReader(std::string_view text) : rest_(text) {}

  Header read() {
    Header header;
    bool has_type = false, has_order = false, has_shape = false;
    expect('{');
    while (!take('}')) {
      const std::string key = quoted();
      expect(':');
      if (key == "descr") {
        header.type = quoted();
        has_type = true;
      } else if (key == "fortran_order") {
        header.columns_first = boolean();
        has_order = true;
      } else if (key == "shape") {
        header.shape = tuple();
        has_shape = true;
      } else {
        refuse();
      }
      if (!take(',')) {
        expect('}');
        break;
      }
    }
    skip_blanks();
    if (!rest_.empty() || !has_type || !has_order || !has_shape) refuse();
    return header;
  }

 private:
  [[noreturn]] static void refuse() { throw FileError("the NumPy file's header is damaged"); }

  void skip_blanks() {
    const auto start = rest_.find_first_not_of(" \n");
    rest_.remove_prefix(std::min(start, rest_.size()));
  }
  bool take(char wanted) {
    skip_blanks();
    if (!rest_.starts_with(wanted)) return false;
    rest_.remove_prefix(1);
    return true;
  }
  void expect(char wanted) {
    if (!take(wanted)) refuse();
  }
  std::string quoted() {
    expect('\'');
    const auto end = rest_.find('\'');
    if (end == rest_.npos) refuse();
    std::string text{rest_.substr(0, end)};
    rest_.remove_prefix(end + 1);
    return text;
  }
  bool boolean() {
    skip_blanks();
    const std::string_view word = rest_.starts_with("True") ? "True" : "False";
    if (!rest_.starts_with(word)) refuse();
    rest_.remove_prefix(word.size());
    return word == "True";
  }
  std::vector<std::uint64_t> tuple() {
    std::vector<std::uint64_t> values;
    expect('(');
    while (!take(')')) {
      skip_blanks();
      const auto [stop, error] =
          std::from_chars(rest_.data(), rest_.data() + rest_.size(), values.emplace_back());
      if (error != std::errc{}) refuse();
      rest_.remove_prefix(static_cast<std::size_t>(stop - rest_.data()));
      if (!take(',')) {
        expect(')');
        break;
      }
    }
    return values;
  }

  std::string_view rest_;
};

/// Splits the file at the end of its header.
Header take_header(std::span<const std::byte>& rest) {
  const FileError truncated{"the NumPy file is cut short in its header"};
  if (rest.size() < kMagic.size() + 4) throw truncated;
  if (!std::equal(kMagic.begin(), kMagic.end(), rest.begin(),
                  [](char c, std::byte b) { return static_cast<std::byte>(c) == b; })) {
    throw FileError("it is not a NumPy file");
  }
  const auto version = little_endian<std::uint16_t>(rest.subspan(kMagic.size()));
  rest = rest.subspan(kMagic.size() + 2);
  if (version != 1 && version != 2) {
    throw FileError("the NumPy file's version must be 1.0 or 2.0");
  }
  const std::size_t length_bytes = version == 1 ? 2 : 4;
  if (rest.size() < length_bytes) throw truncated;
  const std::size_t length =
      version == 1 ? little_endian<std::uint16_t>(rest) : little_endian<std::uint32_t>(rest);
  rest = rest.subspan(length_bytes);
  if (rest.size() < length) throw truncated;
  const std::string_view text{reinterpret_cast<const char*>(rest.data()), length};
  rest = rest.subspan(length);
  return HeaderReader{text}.read();
}

}  // namespace

Bytes encode_npy(const Image& image) {
  const int channels = channel_count(image.format);
  const std::size_t value_bytes =
      bytes_per_texel(image.format) / static_cast<std::size_t>(channels);
  const char* const type = value_bytes == 1 ? "|u1" : value_bytes == 2 ? "<f2" : "<f4";
  std::string header = std::string{"{'descr': '"} + type + "', 'fortran_order': False, 'shape': (" +
                       std::to_string(image.height) + ", " + std::to_string(image.width) + ", " +
                       std::to_string(channels) + "), }";
  const std::size_t before = kMagic.size() + 4;
  const std::size_t end = (before + header.size() + 1 + kAlignment - 1) / kAlignment * kAlignment;
  header.append(end - before - header.size() - 1, ' ');
  header.push_back('\n');

  Bytes bytes;
  bytes.reserve(end + bytes_per_texel(image.format) * static_cast<std::size_t>(image.width) *
                          static_cast<std::size_t>(image.height));
  for (const char c : kMagic) bytes.push_back(static_cast<std::byte>(c));
  append_little_endian(bytes, std::uint16_t{1});  // version 1.0
  append_little_endian(bytes, static_cast<std::uint16_t>(header.size()));
  for (const char c : header) bytes.push_back(static_cast<std::byte>(c));
  for (int y = 0; y < image.height; ++y) {
    switch (value_bytes) {
      case 1:
        for (const std::uint8_t value : row<std::uint8_t>(image, y)) {
          append_little_endian(bytes, value);
        }
        break;
      case 2:
        for (const std::uint16_t half : row<std::uint16_t>(image, y)) {
          append_little_endian(bytes, half);
        }
        break;
      default:
        for (const float value : row<float>(image, y)) {
          append_little_endian(bytes, std::bit_cast<std::uint32_t>(value));
        }
    }
  }
  return bytes;
}

Picture decode_npy(std::span<const std::byte> bytes) {
  auto rest = bytes;
  const Header header = take_header(rest);
  if (header.type != "<f2" && header.type != "<f4") {
    throw FileError("the NumPy array holds '" + header.type + "'; it must be '<f2' or '<f4'");
  }
  const auto& shape = header.shape;
  const auto is_side = [](std::uint64_t side) { return side >= 1 && side <= kMaxImageSize; };
  if (header.columns_first || shape.size() != 3 || !is_side(shape[0]) || !is_side(shape[1]) ||
      (shape[2] != 3 && shape[2] != 4)) {
    throw FileError(
        "the NumPy array must be in C order and of shape (height, width, 3 or 4), "
        "each side 1 to " +
        std::to_string(kMaxImageSize));
  }
  const std::size_t value_bytes = header.type == "<f2" ? 2 : 4;
  const std::uint64_t size = shape[0] * shape[1] * shape[2] * value_bytes;
  if (rest.size() != size) {
    throw FileError("the NumPy file has " + std::to_string(rest.size()) +
                    " bytes of values where its shape needs " + std::to_string(size));
  }
  Picture picture{
      make_image(Format::rgba16f, static_cast<int>(shape[1]), static_cast<int>(shape[0])),
      shape[2] == 4};
  for (int y = 0; y < picture.image.height; ++y) {
    const auto values = row<std::uint16_t>(picture.image, y);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (i % 4 == 3 && !picture.has_alpha) continue;
      values[i] = value_bytes == 2
                      ? little_endian<std::uint16_t>(rest)
                      : float_to_half(std::bit_cast<float>(little_endian<std::uint32_t>(rest)),
                                      HalfRounding::nearest_even);
      rest = rest.subspan(value_bytes);
    }
  }
  return picture;
}

}  // namespace softfocus

// Portable float map (Paul Debevec's): three lines of text, then binary32 rows, the
// lowest first. A negative scale says little-endian; its size says nothing here. Photoshop's have
// the top row first.

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <string>
#include <utility>

#include "raster/images/texel.h"
#include "scenes/files/decimal.h"
#include "tools/cli/errors.h"
#include "tools/files/byte_order.h"
#include "tools/pictures/picture_file.h"
#include "tools/pictures/picture_rows.h"

namespace softfocus {
namespace {

constexpr std::size_t kTexelBytes = 3 * sizeof(float);

bool is_space(std::byte b) {
  return b == std::byte{' '} || b == std::byte{'\n'} || b == std::byte{'\r'} ||
         b == std::byte{'\t'};
}

/// Takes white space and comments, from # to the line's end, as netpbm's files have them. Returns
/// whether there was a line's end.
bool take_blanks(std::span<const std::byte>& rest) {
  bool ended = false, in_comment = false;
  while (!rest.empty()) {
    const std::byte b = rest.front();
    const bool ends_line = b == std::byte{'\n'} || b == std::byte{'\r'};
    if (b == std::byte{'#'}) in_comment = true;
    if (!in_comment && !is_space(b)) break;
    if (ends_line) in_comment = false;
    ended = ended || ends_line;
    rest = rest.subspan(1);
  }
  return ended;
}

/// Takes the next word of the header, but not what is behind it.
std::string_view take_word(std::span<const std::byte>& rest) {
  constexpr std::size_t kLongestWord = 32;
  const auto limit = rest.first(std::min(rest.size(), kLongestWord));
  const auto end = std::find_if(limit.begin(), limit.end(), is_space);
  if (end == limit.end()) throw FileError("the PFM's header is cut short or is not one");
  const auto length = static_cast<std::size_t>(end - limit.begin());
  const std::string_view word{reinterpret_cast<const char*>(rest.data()), length};
  rest = rest.subspan(length);
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

struct PfmHeader {
  std::size_t channels = 3;
  int width = 0, height = 0;
  bool low_byte_first = true;
  /// As Photoshop writes it. Its mark is that the height stands on a line of its own.
  bool top_first = false;
  std::size_t length = 0;
};

/// `beginning` has the header at the least of a file of `file_bytes`.
PfmHeader pfm_header(std::span<const std::byte> beginning, std::uint64_t file_bytes,
                     int most_rows) {
  PfmHeader header;
  auto rest = beginning;
  const std::string_view mark = take_word(rest);
  if (mark != "PF" && mark != "Pf") throw FileError("the PFM must begin with 'PF' or 'Pf'");
  header.channels = mark == "PF" ? 3 : 1;
  take_blanks(rest);
  header.width = whole_number(take_word(rest));
  header.top_first = take_blanks(rest);
  header.height = whole_number(take_word(rest));
  take_blanks(rest);
  const float scale = number(take_word(rest));
  check_picture_size("the PFM", header.width, header.height, most_rows);
  if (!std::isfinite(scale) || scale == 0.0f) {
    throw FileError("the PFM's scale must be a number below or above 0");
  }
  header.low_byte_first = scale < 0.0f;
  const auto size = header.channels * sizeof(float) * static_cast<std::uint64_t>(header.width) *
                    static_cast<std::uint64_t>(header.height);
  // One white space ends the header, or two, CR and LF, or blanks before it: the size tells.
  const auto end = std::find_if(rest.begin(), rest.end(), [](std::byte b) { return !is_space(b); });
  const auto most = static_cast<std::uint64_t>(end - rest.begin());
  const std::uint64_t behind = file_bytes - (beginning.size() - rest.size());
  const std::uint64_t blanks = behind > size && behind - size <= most ? behind - size : 1;
  header.length = beginning.size() - rest.size() + static_cast<std::size_t>(blanks);
  if (file_bytes - header.length != size) {
    throw FileError("the PFM has " + std::to_string(file_bytes - header.length) +
                    " bytes of values where its size needs " + std::to_string(size));
  }
  return header;
}

float take_float(std::span<const std::byte>& rest, bool low_byte_first) {
  const auto bits =
      low_byte_first ? little_endian<std::uint32_t>(rest) : big_endian<std::uint32_t>(rest);
  rest = rest.subspan(sizeof bits);
  return std::bit_cast<float>(bits);
}

}  // namespace

Bytes pfm_start(int width, int height) {
  Bytes bytes;
  for (const char c : "PF\n" + std::to_string(width) + " " + std::to_string(height) + "\n-1.0\n") {
    bytes.push_back(static_cast<std::byte>(c));
  }
  return bytes;
}

void append_pfm_rows(Bytes& bytes, const ConstImageView& image, float light) {
  bytes.reserve(bytes.size() + kTexelBytes * static_cast<std::size_t>(image.width) *
                                   static_cast<std::size_t>(image.height));
  for (int y = image.height - 1; y >= 0; --y) {
    for (int x = 0; x < image.width; ++x) {
      const glm::vec4 colour = load_texel<Format::rgba16f>(image, x, y);
      for (int c = 0; c < 3; ++c) {
        append_little_endian(bytes, std::bit_cast<std::uint32_t>(colour[c] * light));
      }
    }
  }
}

Bytes encode_pfm(const Image& image, float light) {
  Bytes bytes = pfm_start(image.width, image.height);
  append_pfm_rows(bytes, image, light);
  return bytes;
}

Bytes encode_grey_pfm(std::span<const float> values, int width, int height) {
  const std::string header =
      "Pf\n" + std::to_string(width) + " " + std::to_string(height) + "\n-1.0\n";
  Bytes bytes;
  bytes.reserve(header.size() + sizeof(float) * values.size());
  for (const char c : header) bytes.push_back(static_cast<std::byte>(c));
  const auto columns = static_cast<std::size_t>(width);
  for (std::size_t y = static_cast<std::size_t>(height); y-- > 0;) {
    for (const float value : values.subspan(y * columns, columns)) {
      append_little_endian(bytes, std::bit_cast<std::uint32_t>(value));
    }
  }
  return bytes;
}

Picture decode_pfm(std::span<const std::byte> bytes) {
  const PfmHeader header = pfm_header(bytes, bytes.size(), kMaxImageSize);
  if (header.channels != 3) throw FileError("the PFM must be a colour one, 'PF'");
  auto rest = bytes.subspan(header.length);
  Picture picture{make_image(Format::rgba16f, header.width, header.height), false};
  for (int y = 0; y < header.height; ++y) {
    const auto values =
        row<std::uint16_t>(picture.image, header.top_first ? y : header.height - 1 - y);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (i % 4 == 3) continue;
      values[i] =
          float_to_half(take_float(rest, header.low_byte_first), HalfRounding::nearest_even);
    }
  }
  return picture;
}

namespace {

bool begins_as_pfm(std::span<const std::byte> bytes) {
  return bytes.size() >= 2 && bytes[0] == std::byte{'P'} &&
         (bytes[1] == std::byte{'F'} || bytes[1] == std::byte{'f'});
}

PfmHeader pfm_header(const PictureFile& file) {
  return pfm_header(file.bytes, source_of(file).size(), most_rows_of(file));
}

void list_pfm(PictureFile& file) {
  const PfmHeader header = pfm_header(file);
  file.width = header.width;
  file.height = header.height;
  file.top_first = header.top_first;
  if (header.top_first) file.remark = "its top row first, as Photoshop writes it";
  for (const char name : std::string_view{header.channels == 3 ? "RGB" : "Y"}) {
    file.planes.push_back({.name = std::string{name}, .type = NumberType::single});
  }
}

ReadRows pfm_rows(const PictureFile& file, std::vector<std::size_t> planes) {
  return [header = pfm_header(file), source = source_of(file), planes = std::move(planes),
          top_first = file.top_first,
          buffer = Bytes{}](Rows rows, std::span<PlaneValues> values) mutable {
    const auto columns = static_cast<std::size_t>(header.width);
    const std::size_t row_bytes = columns * header.channels * sizeof(float);
    const auto before = static_cast<std::uint64_t>(
        top_first ? rows.first : header.height - rows.first - rows.count);
    const auto bytes = source.at(header.length + before * row_bytes,
                                 static_cast<std::size_t>(rows.count) * row_bytes, buffer);
    for (std::size_t i = 0; i < planes.size(); ++i) {
      for (std::size_t place = 0; place < values[i].size(); ++place) {
        auto at = bytes.subspan(sizeof(float) * (header.channels * place + planes[i]));
        const std::size_t below = place / columns;
        const std::size_t y = top_first ? below : static_cast<std::size_t>(rows.count) - 1 - below;
        values[i][y * columns + place % columns] = take_float(at, header.low_byte_first);
      }
    }
  };
}

}  // namespace

const PictureFileReader kPfmReader{"PFM", begins_as_pfm, list_pfm, nullptr, true, pfm_rows};

}  // namespace softfocus

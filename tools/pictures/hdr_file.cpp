// Radiance HDR (Ward 1991): lines of text, an empty one, the size, then
// rows of RGBE: three mantissas of 8 bits with one exponent, in runs for each of the four bytes.
//
//   value = mantissa * 2^(exponent - 136), all 0 if the exponent is 0

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>

#include "raster/images/texel.h"
#include "scenes/files/decimal.h"
#include "tools/cli/errors.h"
#include "tools/pictures/picture_file.h"
#include "tools/pictures/picture_rows.h"

namespace softfocus {
namespace {

using Rgbe = std::array<std::uint8_t, 4>;

[[noreturn]] void refuse_as_damaged(const char* where) {
  throw FileError(std::string{"the HDR is damaged in its "} + where);
}

bool begins_as_hdr(std::span<const std::byte> bytes) {
  const std::string_view text{reinterpret_cast<const char*>(bytes.data()),
                              std::min<std::size_t>(bytes.size(), 16)};
  return text.starts_with("#?RADIANCE") || text.starts_with("#?RGBE");
}

/// Takes a line, without its end.
std::string_view take_line(std::string_view& rest) {
  constexpr std::size_t kLongestLine = 65536;
  const auto end = rest.substr(0, kLongestLine).find('\n');
  if (end == rest.npos) refuse_as_damaged("header");
  std::string_view line = rest.substr(0, end);
  rest.remove_prefix(end + 1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

int take_number(std::string_view& rest) {
  int value = 0;
  const auto [stop, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
  if (error != std::errc{}) refuse_as_damaged("size");
  rest.remove_prefix(static_cast<std::size_t>(stop - rest.data()));
  return value;
}

struct HdrHeader {
  int width = 0, height = 0;
  bool from_below = false;
  double exposure = 1.0;  ///< by which the values were multiplied
  std::size_t length = 0;
};

HdrHeader hdr_header(std::span<const std::byte> bytes) {
  const std::string_view all{reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  std::string_view rest = all;
  HdrHeader header;
  for (take_line(rest);;) {
    const std::string_view line = take_line(rest);
    if (line.empty()) break;
    if (line.starts_with("FORMAT=") && line != "FORMAT=32-bit_rle_rgbe") {
      throw FileError("the HDR's FORMAT is '" + std::string{line.substr(7)} +
                      "'; 32-bit_rle_rgbe would do");
    }
    if (line.starts_with("EXPOSURE=")) {
      const auto blanks = std::min(line.find_first_not_of(' ', 9), line.size());
      const auto value = decimal_to_float(line.substr(blanks));
      if (!value || !(*value > 0.0f)) refuse_as_damaged("EXPOSURE");
      header.exposure *= static_cast<double>(*value);
    }
  }
  std::string_view size = take_line(rest);
  if (!size.starts_with("-Y ") && !size.starts_with("+Y ")) {
    throw FileError("the HDR is turned; rows from left to right, '-Y HEIGHT +X WIDTH', would do");
  }
  header.from_below = size.starts_with('+');
  size.remove_prefix(3);
  header.height = take_number(size);
  if (!size.starts_with(" +X ")) refuse_as_damaged("size");
  size.remove_prefix(4);
  header.width = take_number(size);
  if (!size.empty()) refuse_as_damaged("size");
  check_picture_size("the HDR", header.width, header.height);
  header.length = all.size() - rest.size();
  return header;
}

void list_hdr(PictureFile& file) {
  const HdrHeader header = hdr_header(file.bytes);
  file.width = header.width;
  file.height = header.height;
  for (const char* name : {"R", "G", "B"}) {
    file.planes.push_back({.name = name, .type = NumberType::single});
  }
  // A run covers 127 bytes at most and takes two; old ones, of a pixel, 8 bytes or more a row.
  const auto least =
      static_cast<std::uint64_t>(header.height) *
      std::min<std::uint64_t>(8, 4 + 8 * ((static_cast<std::uint64_t>(header.width) + 126) / 127));
  const auto flat =
      static_cast<std::uint64_t>(header.height) * static_cast<std::uint64_t>(header.width) * 4;
  if (file.bytes.size() - header.length < std::min(least, flat)) {
    throw FileError("the HDR is too small a file for the size that it claims");
  }
}

std::uint8_t take_byte(std::span<const std::byte>& rest) {
  if (rest.empty()) refuse_as_damaged("pixels: the file is cut short");
  const auto byte = std::to_integer<std::uint8_t>(rest.front());
  rest = rest.subspan(1);
  return byte;
}

/// Pixels one after the other. In files of before 1991, 1 1 1 and a count repeat the last pixel; of
/// several behind each other each counts 256 times as much as the one before.
void read_flat_row(std::span<const std::byte>& rest, std::vector<Rgbe>& row) {
  int shift = 0;
  for (std::size_t x = 0; x < row.size();) {
    Rgbe pixel{};
    for (std::uint8_t& byte : pixel) byte = take_byte(rest);
    if (x == 0 || pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
      row[x++] = pixel;
      shift = 0;
      continue;
    }
    const std::size_t count = std::size_t{pixel[3]} << shift;
    shift += 8;
    if (shift > 24 || count > row.size() - x) refuse_as_damaged("old runs");
    std::fill_n(row.begin() + static_cast<std::ptrdiff_t>(x), count, row[x - 1]);
    x += count;
  }
}

void read_row(std::span<const std::byte>& rest, std::vector<Rgbe>& row) {
  const std::size_t width = row.size();
  const bool in_runs = rest.size() >= 4 && rest[0] == std::byte{2} && rest[1] == std::byte{2} &&
                       std::to_integer<int>(rest[2]) < 128 && width >= 8 && width < 32768;
  if (!in_runs) return read_flat_row(rest, row);
  if (static_cast<std::size_t>(std::to_integer<int>(rest[2]) << 8 |
                               std::to_integer<int>(rest[3])) != width) {
    refuse_as_damaged("rows: one has another width");
  }
  rest = rest.subspan(4);
  for (std::size_t c = 0; c < 4; ++c) {
    for (std::size_t x = 0; x < width;) {
      std::size_t count = take_byte(rest);
      const bool repeats = count > 128;
      if (repeats) count -= 128;
      if (count == 0 || count > width - x) refuse_as_damaged("runs");
      std::uint8_t byte = 0;
      for (std::size_t i = 0; i < count; ++i) {
        if (i == 0 || !repeats) byte = take_byte(rest);
        row[x++][c] = byte;
      }
    }
  }
}

void read_hdr(const PictureFile& file, std::span<const std::size_t> planes,
              std::span<PlaneValues> values) {
  const HdrHeader header = hdr_header(file.bytes);
  auto rest = std::span<const std::byte>{file.bytes}.subspan(header.length);
  std::vector<Rgbe> pixels(static_cast<std::size_t>(file.width));
  for (int i = 0; i < file.height; ++i) {
    const int y = header.from_below ? file.height - 1 - i : i;
    read_row(rest, pixels);
    for (std::size_t p = 0; p < planes.size(); ++p) {
      const auto start = static_cast<std::size_t>(y) * pixels.size();
      for (std::size_t x = 0; x < pixels.size(); ++x) {
        const Rgbe& pixel = pixels[x];
        const double value =
            pixel[3] == 0 ? 0.0 : std::ldexp(static_cast<double>(pixel[planes[p]]), pixel[3] - 136);
        values[p][start + x] = static_cast<float>(value / header.exposure);
      }
    }
  }
}

/// Mantissas rounded to nearest. Values below 0 and NaN become 0.
Rgbe rgbe_of(glm::vec4 colour, float times) {
  const auto light = [times](float value) {
    return value > 0.0f ? static_cast<double>(std::min(value, 65504.0f) * times) : 0.0;
  };
  const std::array values{light(colour.x), light(colour.y), light(colour.z)};
  const double most = std::max({values[0], values[1], values[2]});
  if (most < 1e-9) return {};
  int exponent = 0;
  std::frexp(most, &exponent);
  if (std::ldexp(most, 8 - exponent) >= 255.5) ++exponent;
  Rgbe pixel{};
  for (std::size_t c = 0; c < 3; ++c) {
    pixel[c] = static_cast<std::uint8_t>(std::ldexp(values[c], 8 - exponent) + 0.5);
  }
  pixel[3] = static_cast<std::uint8_t>(exponent + 128);
  return pixel;
}

/// A row's byte `c`: runs of four or more, and what lies between them as it is.
void append_runs(Bytes& bytes, const std::vector<Rgbe>& row, std::size_t c) {
  const auto put = [&](std::size_t value) { bytes.push_back(static_cast<std::byte>(value)); };
  const auto run_at = [&](std::size_t x) {
    std::size_t count = 1;
    while (count < 127 && x + count < row.size() && row[x + count][c] == row[x][c]) ++count;
    return count;
  };
  for (std::size_t x = 0; x < row.size();) {
    if (const std::size_t run = run_at(x); run >= 4) {
      put(128 + run);
      put(row[x][c]);
      x += run;
      continue;
    }
    std::size_t end = x + 1;
    while (end < row.size() && end - x < 128 && run_at(end) < 4) ++end;
    put(end - x);
    for (; x < end; ++x) put(row[x][c]);
  }
}

}  // namespace

Bytes hdr_start(int width, int height) {
  Bytes bytes;
  for (const char c : "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(height) +
                          " +X " + std::to_string(width) + "\n") {
    bytes.push_back(static_cast<std::byte>(c));
  }
  return bytes;
}

void append_hdr_rows(Bytes& bytes, const ConstImageView& image, float light) {
  const bool in_runs = image.width >= 8;  // fewer have no such form
  std::vector<Rgbe> pixels(static_cast<std::size_t>(image.width));
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      pixels[static_cast<std::size_t>(x)] =
          rgbe_of(load_texel<Format::rgba16f>(image, x, y), light);
    }
    if (!in_runs) {
      for (const Rgbe& pixel : pixels) {
        for (const std::uint8_t byte : pixel) bytes.push_back(static_cast<std::byte>(byte));
      }
      continue;
    }
    for (const int byte : {2, 2, image.width >> 8, image.width & 0xFF}) {
      bytes.push_back(static_cast<std::byte>(byte));
    }
    for (std::size_t c = 0; c < 4; ++c) append_runs(bytes, pixels, c);
  }
}

Bytes encode_hdr(const Image& image, float light) {
  Bytes bytes = hdr_start(image.width, image.height);
  append_hdr_rows(bytes, image, light);
  return bytes;
}

const PictureFileReader kHdrReader{"HDR", begins_as_hdr, list_hdr, read_hdr};

}  // namespace softfocus

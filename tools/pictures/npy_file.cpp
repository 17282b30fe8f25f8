// NumPy's array file: a magic word, a version, the length of the header, the header,
// which is a Python dict literal padded with blanks, and the values.
// numpy/lib/format.py describes it.

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <string>
#include <utility>

#include "raster/images/image.h"
#include "raster/numbers/half.h"
#include "tools/cli/errors.h"
#include "tools/files/byte_order.h"
#include "tools/pictures/picture_file.h"
#include "tools/pictures/picture_rows.h"

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
        if (take('[')) {
          throw FileError(
              "the NumPy array is structured, with names for its values; save one of plain "
              "numbers, "
              "as numpy.stack([a[n] for n in a.dtype.names], -1) makes");
        }
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

/// An array as a picture.
struct NpyPicture {
  NumberType type = NumberType::half;
  std::size_t value_bytes = 2;
  bool columns_first = false;
  std::size_t width = 0, height = 0, channels = 0;
  std::size_t header_bytes = 0;
};

struct NpyType {
  std::string_view name;
  NumberType type;
  std::size_t bytes;
};
constexpr std::array kNpyTypes{
    NpyType{"<f2", NumberType::half, 2}, NpyType{"<f4", NumberType::single, 4},
    NpyType{"<f8", NumberType::double_precision, 8}, NpyType{"|u1", NumberType::unsigned8, 1},
    NpyType{"<u2", NumberType::unsigned16, 2}};

/// `beginning` has the header at the least of a file of `file_bytes`.
NpyPicture npy_picture(std::span<const std::byte> beginning, std::uint64_t file_bytes,
                       int most_rows) {
  NpyPicture picture;
  std::span<const std::byte> rest = beginning;
  const Header header = take_header(rest);
  picture.header_bytes = beginning.size() - rest.size();
  const auto type = std::find_if(kNpyTypes.begin(), kNpyTypes.end(),
                                 [&](const NpyType& known) { return known.name == header.type; });
  if (type == kNpyTypes.end()) {
    throw FileError("the NumPy array holds '" + header.type +
                    "'; it must be '<f2', '<f4', '<f8', '|u1' or '<u2'");
  }
  picture.type = type->type;
  picture.value_bytes = type->bytes;
  picture.columns_first = header.columns_first;
  auto shape = header.shape;
  if (shape.size() == 2) shape.push_back(1);
  const auto is_side = [](std::uint64_t side, int most) {
    return side >= 1 && side <= static_cast<std::uint64_t>(most);
  };
  if (shape.size() != 3 || !is_side(shape[0], most_rows) || !is_side(shape[1], kMaxImageSize) ||
      shape[2] < 1 || shape[2] > 4) {
    throw FileError(
        "the NumPy array must be of shape (height, width) or (height, width, 1 to 4), each side 1 "
        "to " +
        std::to_string(kMaxImageSize) +
        (most_rows > kMaxImageSize ? ", the height to " + std::to_string(most_rows) : ""));
  }
  picture.height = static_cast<std::size_t>(shape[0]);
  picture.width = static_cast<std::size_t>(shape[1]);
  picture.channels = static_cast<std::size_t>(shape[2]);
  const std::uint64_t size = shape[0] * shape[1] * shape[2] * picture.value_bytes;
  const std::uint64_t there = file_bytes - picture.header_bytes;
  if (there != size) {
    throw FileError("the NumPy file has " + std::to_string(there) +
                    " bytes of values where its shape needs " + std::to_string(size));
  }
  return picture;
}

float npy_value(NumberType type, std::span<const std::byte> at) {
  switch (type) {
    case NumberType::half: return half_to_float(little_endian<std::uint16_t>(at));
    case NumberType::single: return std::bit_cast<float>(little_endian<std::uint32_t>(at));
    case NumberType::double_precision:
      return static_cast<float>(std::bit_cast<double>(little_endian<std::uint64_t>(at)));
    case NumberType::unsigned8: return static_cast<float>(std::to_integer<int>(at[0]));
    default: return static_cast<float>(little_endian<std::uint16_t>(at));
  }
}

Bytes npy_start(std::string_view type, const std::string& shape) {
  std::string header =
      "{'descr': '" + std::string{type} + "', 'fortran_order': False, 'shape': (" + shape + "), }";
  const std::size_t before = kMagic.size() + 4;
  const std::size_t end = (before + header.size() + 1 + kAlignment - 1) / kAlignment * kAlignment;
  header.append(end - before - header.size() - 1, ' ');
  header.push_back('\n');

  Bytes bytes;
  for (const char c : kMagic) bytes.push_back(static_cast<std::byte>(c));
  append_little_endian(bytes, std::uint16_t{1});  // version 1.0
  append_little_endian(bytes, static_cast<std::uint16_t>(header.size()));
  for (const char c : header) bytes.push_back(static_cast<std::byte>(c));
  return bytes;
}

}  // namespace

Bytes npy_start(const ConstImageView& image, int height) {
  const int channels = channel_count(image.format);
  const std::size_t value_bytes =
      bytes_per_texel(image.format) / static_cast<std::size_t>(channels);
  const char* const type = value_bytes == 1 ? "|u1" : value_bytes == 2 ? "<f2" : "<f4";
  return npy_start(type, std::to_string(height) + ", " + std::to_string(image.width) + ", " +
                             std::to_string(channels));
}

void append_npy_rows(Bytes& bytes, const ConstImageView& image) {
  const std::size_t texel_bytes = bytes_per_texel(image.format);
  const std::size_t row_bytes = texel_bytes * static_cast<std::size_t>(image.width);
  bytes.reserve(bytes.size() + row_bytes * static_cast<std::size_t>(image.height));
  for (int y = 0; y < image.height; ++y) {
    if (std::endian::native == std::endian::little) {
      const std::byte* from = image.texels + y * image.stride_bytes;
      bytes.insert(bytes.end(), from, from + row_bytes);
      continue;
    }
    switch (texel_bytes / static_cast<std::size_t>(channel_count(image.format))) {
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
}

Bytes encode_npy(const Image& image) {
  Bytes bytes = npy_start(image, image.height);
  append_npy_rows(bytes, image);
  return bytes;
}

Bytes encode_grey_npy(std::span<const float> values, int width, int height) {
  Bytes bytes = npy_start("<f4", std::to_string(height) + ", " + std::to_string(width));
  bytes.reserve(bytes.size() + sizeof(float) * values.size());
  for (const float value : values) {
    append_little_endian(bytes, std::bit_cast<std::uint32_t>(value));
  }
  return bytes;
}

Picture decode_npy(std::span<const std::byte> bytes) {
  const NpyPicture array = npy_picture(bytes, bytes.size(), kMaxImageSize);
  const bool is_half = array.type == NumberType::half;
  if ((!is_half && array.type != NumberType::single) || array.columns_first || array.channels < 3) {
    PictureFile file{.path = {}, .bytes = {bytes.begin(), bytes.end()}, .reader = &kNpyReader};
    kNpyReader.list(file);
    return read_colour(file, colour_layers(file).front(), true);
  }
  Picture picture{
      make_image(Format::rgba16f, static_cast<int>(array.width), static_cast<int>(array.height)),
      array.channels == 4};
  auto rest = bytes.subspan(array.header_bytes);
  for (int y = 0; y < picture.image.height; ++y) {
    const auto values = row<std::uint16_t>(picture.image, y);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (i % 4 == 3 && !picture.has_alpha) continue;
      values[i] = is_half ? little_endian<std::uint16_t>(rest)
                          : float_to_half(npy_value(array.type, rest), HalfRounding::nearest_even);
      rest = rest.subspan(array.value_bytes);
    }
  }
  return picture;
}

namespace {

bool begins_as_npy(std::span<const std::byte> bytes) {
  return bytes.size() >= kMagic.size() &&
         std::equal(kMagic.begin(), kMagic.end(), bytes.begin(),
                    [](char c, std::byte b) { return static_cast<std::byte>(c) == b; });
}

NpyPicture npy_picture(const PictureFile& file) {
  return npy_picture(file.bytes, source_of(file).size(), most_rows_of(file));
}

void list_npy(PictureFile& file) {
  const NpyPicture array = npy_picture(file);
  file.width = static_cast<int>(array.width);
  file.height = static_cast<int>(array.height);
  constexpr std::array<std::string_view, 4> kNames{"Y", "YA", "RGB", "RGBA"};
  for (const char name : kNames[array.channels - 1]) {
    file.planes.push_back({.name = std::string{name}, .type = array.type});
  }
  file.is_srgb = array.type == NumberType::unsigned8 || array.type == NumberType::unsigned16;
  file.has_rows = !array.columns_first;
  if (array.columns_first) file.remark = "Fortran order";
}

/// An array by columns is read whole.
ReadRows npy_rows(const PictureFile& file, std::vector<std::size_t> planes) {
  return [array = npy_picture(file), source = source_of(file), planes = std::move(planes),
          buffer = Bytes{}](Rows rows, std::span<PlaneValues> values) mutable {
    const std::size_t row_bytes = array.width * array.channels * array.value_bytes;
    const auto first = static_cast<std::size_t>(rows.first);
    const auto count = static_cast<std::size_t>(rows.count);
    const auto bytes =
        source.at(array.header_bytes + std::uint64_t{first} * row_bytes, count * row_bytes, buffer);
    for (std::size_t i = 0; i < planes.size(); ++i) {
      float* to = values[i].data();
      for (std::size_t y = 0; y < count; ++y) {
        for (std::size_t x = 0; x < array.width; ++x) {
          const std::size_t place = array.columns_first
                                        ? (planes[i] * array.width + x) * array.height + y
                                        : (y * array.width + x) * array.channels + planes[i];
          *to++ = npy_value(array.type, bytes.subspan(place * array.value_bytes));
        }
      }
    }
  };
}

}  // namespace

const PictureFileReader kNpyReader{"NumPy", begins_as_npy, list_npy, nullptr, true, npy_rows};

}  // namespace softfocus

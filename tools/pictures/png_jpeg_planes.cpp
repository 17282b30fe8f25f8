// PNG and JPEG through stb_image, which scenes/load compiles.

#include <stb_image.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "scenes/files/picture_check.h"
#include "tools/cli/errors.h"
#include "tools/files/byte_order.h"
#include "tools/pictures/picture_file.h"
#include "tools/pictures/png_text.h"

namespace softfocus {
namespace {

/// A deflate stream is at most so many times as large as its file.
constexpr std::uint64_t kMostOfDeflate = 1032;
/// A JPEG has at least a bit for each block of 8x8 pixels.
constexpr std::uint64_t kMostPixelsOfJpegByte = 512;

const stbi_uc* data_of(const PictureFile& file) {
  return reinterpret_cast<const stbi_uc*>(file.bytes.data());
}
int size_of(const PictureFile& file) { return static_cast<int>(file.bytes.size()); }

std::uint64_t pixels_of(const PictureFile& file) {
  return static_cast<std::uint64_t>(file.width) * static_cast<std::uint64_t>(file.height);
}

[[noreturn]] void refuse_as_damaged(std::string_view kind, std::string_view reason) {
  throw FileError(std::string{kind} + " is damaged: " + std::string{reason});
}

void list_channels(PictureFile& file, std::string_view kind, NumberType type) {
  if (file.bytes.size() > 0x7FFFFFFF) throw FileError(std::string{kind} + " is larger than 2 GB");
  int channels = 0;
  if (stbi_info_from_memory(data_of(file), size_of(file), &file.width, &file.height, &channels) ==
      0) {
    refuse_as_damaged(kind, stbi_failure_reason());
  }
  check_picture_size(kind, file.width, file.height);
  // stb before 2.28 counts the alpha of a transparent colour only once it reads the pixels.
  const bool has_alpha = channels % 2 == 0;
  if (!has_alpha && is_png(file.bytes) && has_transparent_colour(file.bytes)) ++channels;
  constexpr std::string_view kNames[] = {"Y", "YA", "RGB", "RGBA"};
  for (const char name : kNames[channels - 1]) {
    file.planes.push_back({.name = std::string{name}, .type = type});
  }
  file.is_srgb = true;
}

/// The wanted channels of interleaved values.
template <class Value>
void take_channels(const PictureFile& file, const Value* from, std::span<const std::size_t> planes,
                   std::span<PlaneValues> values) {
  const std::size_t channels = file.planes.size();
  std::size_t to = 0;
  for (int y = 0; y < file.height; ++y) {
    for (int x = 0; x < file.width; ++x, ++to) {
      const std::size_t at = file.exif_orientation == 1 ? to : stored_place(file, x, y);
      for (std::size_t i = 0; i < planes.size(); ++i) {
        values[i][to] = static_cast<float>(from[at * channels + planes[i]]);
      }
    }
  }
}

void read_channels(const PictureFile& file, std::string_view kind,
                   std::span<const std::size_t> planes, std::span<PlaneValues> values) {
  int width = 0, height = 0, channels = 0;
  const bool is_wide = file.planes[0].type == NumberType::unsigned16;
  void* const loaded =
      is_wide ? static_cast<void*>(stbi_load_16_from_memory(data_of(file), size_of(file), &width,
                                                            &height, &channels, 0))
              : stbi_load_from_memory(data_of(file), size_of(file), &width, &height, &channels, 0);
  const std::unique_ptr<void, decltype(&stbi_image_free)> texels{loaded, stbi_image_free};
  if (!texels) refuse_as_damaged(kind, stbi_failure_reason());
  if (file.exif_orientation >= 5) std::swap(width, height);
  if (width != file.width || height != file.height ||
      static_cast<std::size_t>(channels) != file.planes.size()) {
    refuse_as_damaged(kind, "its header and its data differ");
  }
  if (is_wide) {
    take_channels(file, static_cast<const stbi_us*>(loaded), planes, values);
  } else {
    take_channels(file, static_cast<const stbi_uc*>(loaded), planes, values);
  }
}

bool begins_as_jpeg(std::span<const std::byte> bytes) {
  return bytes.size() >= 3 && std::memcmp(bytes.data(), "\xFF\xD8\xFF", 3) == 0;
}

/// The orientation in Exif data (CIPA DC-008, 4.6): a TIFF, of either byte order, whose first
/// directory has it as tag 0x0112, one whole number of 16 bits. 1 if it is not there.
int exif_orientation(std::span<const std::byte> tiff) {
  constexpr std::size_t kHeader = 8, kEntry = 12;
  constexpr std::uint32_t kOrientation = 0x0112, kShort = 3;
  if (tiff.size() < kHeader) return 1;
  const bool low_byte_first = tiff[0] == std::byte{'I'};
  const auto number = [&](std::size_t at, bool is_wide) -> std::uint32_t {
    const auto bytes = tiff.subspan(at);
    if (is_wide) {
      return low_byte_first ? little_endian<std::uint32_t>(bytes)
                            : big_endian<std::uint32_t>(bytes);
    }
    return low_byte_first ? little_endian<std::uint16_t>(bytes) : big_endian<std::uint16_t>(bytes);
  };
  const std::size_t directory = number(4, true);
  if (directory > tiff.size() || tiff.size() - directory < 2) return 1;
  const std::size_t entries = number(directory, false);
  for (std::size_t i = 0; i < entries; ++i) {
    const std::size_t at = directory + 2 + i * kEntry;
    if (at + kEntry > tiff.size()) return 1;
    if (number(at, false) != kOrientation || number(at + 2, false) != kShort) continue;
    const std::uint32_t value = number(at + 8, false);
    return value >= 1 && value <= 8 ? static_cast<int>(value) : 1;
  }
  return 1;
}

/// The data of a JPEG's segments of that marker before the first scan.
std::vector<std::span<const std::byte>> jpeg_segments(std::span<const std::byte> jpeg,
                                                      std::uint32_t wanted) {
  constexpr std::uint32_t kStartOfScan = 0xFFDA;
  std::vector<std::span<const std::byte>> segments;
  for (std::size_t at = 2; at + 4 <= jpeg.size();) {
    const auto marker = big_endian<std::uint16_t>(jpeg.subspan(at));
    const std::size_t length = big_endian<std::uint16_t>(jpeg.subspan(at + 2));
    if (marker == kStartOfScan || length < 2 || at + 2 + length > jpeg.size()) break;
    if (marker == wanted) segments.push_back(jpeg.subspan(at + 4, length - 2));
    at += 2 + length;
  }
  return segments;
}

/// The name in an ICC profile (ICC.1:2022, 7): its tag desc is a count and ASCII or, from version 4
/// on, a list of texts in UTF-16. "without a name" if it cannot be read.
std::string profile_name(std::span<const std::byte> icc) {
  constexpr std::size_t kTagTable = 128, kTag = 12;
  const auto has = [&](std::size_t at) { return at < icc.size() && icc.size() - at >= 4; };
  const auto number = [&](std::size_t at) -> std::size_t {
    return has(at) ? big_endian<std::uint32_t>(icc.subspan(at)) : 0;
  };
  const auto word = [&](std::size_t at) {
    return has(at) ? std::string_view{reinterpret_cast<const char*>(icc.data()) + at, 4}
                   : std::string_view{};
  };
  std::string name;
  for (std::size_t i = 0; i < std::min<std::size_t>(number(kTagTable), 100); ++i) {
    const std::size_t entry = kTagTable + 4 + i * kTag;
    if (word(entry) != "desc") continue;
    const std::size_t at = number(entry + 4);
    const bool is_wide = word(at) == "mluc" && number(at + 8) > 0;
    const std::size_t first = is_wide ? at + number(at + 24) : at + 12;
    const std::size_t count = is_wide ? number(at + 20) : number(at + 8);
    for (std::size_t c = is_wide ? 1 : 0; c < count && first + c < icc.size();
         c += is_wide ? 2 : 1) {
      const char letter = static_cast<char>(icc[first + c]);
      if (letter == '\0') break;
      if (letter >= ' ' && letter <= '~') name += letter;
    }
    break;
  }
  return name.empty() ? "without a name" : name.substr(0, 80);
}

/// A PNG's profile: a name, 0, 0 for deflate, and a stream. Larger ones than any that is known are
/// left out.
Bytes png_profile(std::span<const std::byte> png) {
  constexpr std::size_t kMostOfProfile = std::size_t{1} << 22;
  const auto chunk = find_png_chunk(png, "iCCP");
  const auto end = std::find(chunk.begin(), chunk.end(), std::byte{0});
  if (chunk.end() - end < 3) return {};
  const auto packed = chunk.subspan(static_cast<std::size_t>(end - chunk.begin()) + 2);
  Bytes icc(kMostOfProfile);
  const int size = stbi_zlib_decode_buffer(
      reinterpret_cast<char*>(icc.data()), static_cast<int>(icc.size()),
      reinterpret_cast<const char*>(packed.data()), static_cast<int>(packed.size()));
  icc.resize(static_cast<std::size_t>(std::max(size, 0)));
  return icc;
}

/// A JPEG's profile: in segments APP2, each with its number and how many there are (ICC.1:2022,
/// B.4).
Bytes jpeg_profile(std::span<const std::byte> jpeg) {
  constexpr std::string_view kProfileMark{"ICC_PROFILE\0", 12};
  Bytes icc;
  for (const std::span<const std::byte> data : jpeg_segments(jpeg, 0xFFE2)) {
    if (data.size() > kProfileMark.size() + 2 &&
        std::memcmp(data.data(), kProfileMark.data(), kProfileMark.size()) == 0) {
      icc.insert(icc.end(), data.begin() + kProfileMark.size() + 2, data.end());
    }
  }
  return icc;
}

void list_png(PictureFile& file) {
  check_png_chunks(file.bytes);  // stb reads them without checksums, and does not mind the end
  constexpr std::size_t kDepthAt = 24;
  const bool is_wide = file.bytes.size() > kDepthAt && file.bytes[kDepthAt] == std::byte{16};
  list_channels(file, "the PNG", is_wide ? NumberType::unsigned16 : NumberType::unsigned8);
  // A bit a pixel at least.
  if (pixels_of(file) / 8 > kMostOfDeflate * file.bytes.size()) {
    refuse_as_damaged("the PNG", "it is too small a file for the size that it claims");
  }
  const auto exif = find_png_chunk(file.bytes, "eXIf");
  turn_by_exif(file, exif.empty() ? 1 : exif_orientation(exif));
  take_profile(file, png_profile(file.bytes));
}

void read_png(const PictureFile& file, std::span<const std::size_t> planes,
              std::span<PlaneValues> values) {
  read_channels(file, "the PNG", planes, values);
}

/// A JPEG's orientation: Exif data is in a segment APP1.
int jpeg_orientation(std::span<const std::byte> jpeg) {
  constexpr std::string_view kExifMark{"Exif\0\0", 6};
  for (const std::span<const std::byte> data : jpeg_segments(jpeg, 0xFFE1)) {
    if (data.size() > kExifMark.size() &&
        std::memcmp(data.data(), kExifMark.data(), kExifMark.size()) == 0) {
      return exif_orientation(data.subspan(kExifMark.size()));
    }
  }
  return 1;
}

void list_jpeg(PictureFile& file) {
  const std::string_view text{reinterpret_cast<const char*>(file.bytes.data()), file.bytes.size()};
  if (has_overfull_huffman_table(text)) {
    refuse_as_damaged("the JPEG", "a Huffman table has more than 256 codes");
  }
  if (lacks_huffman_table(text)) {
    refuse_as_damaged("the JPEG", "a scan lacks its Huffman table");
  }
  if (is_cut_jpeg(text)) refuse_as_damaged("the JPEG", "its end is missing");
  list_channels(file, "the JPEG", NumberType::unsigned8);
  turn_by_exif(file, jpeg_orientation(file.bytes));
  take_profile(file, jpeg_profile(file.bytes));
  if (pixels_of(file) > kMostPixelsOfJpegByte * file.bytes.size()) {
    refuse_as_damaged("the JPEG", "it is too small a file for the size that it claims");
  }
}

void read_jpeg(const PictureFile& file, std::span<const std::size_t> planes,
               std::span<PlaneValues> values) {
  read_channels(file, "the JPEG", planes, values);
}

}  // namespace

std::size_t stored_place(const PictureFile& file, int x, int y) {
  const int orientation = file.exif_orientation;
  const bool on_side = orientation >= 5;
  const int width = on_side ? file.height : file.width;
  const int height = on_side ? file.width : file.height;
  if (on_side) std::swap(x, y);
  if (orientation == 2 || orientation == 3 || orientation >= 7) x = width - 1 - x;
  if (orientation == 3 || orientation == 4 || orientation == 6 || orientation == 7) {
    y = height - 1 - y;
  }
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
         static_cast<std::size_t>(x);
}

void turn_by_exif(PictureFile& file, int orientation) {
  if (orientation == 1) return;
  file.exif_orientation = orientation;
  if (orientation >= 5) std::swap(file.width, file.height);
  file.remark = "turned by its EXIF orientation, " + std::to_string(orientation);
}

void take_profile(PictureFile& file, Bytes icc) {
  constexpr std::size_t kHeader = 128, kSpaceAt = 16;
  if (icc.size() < kHeader) return;
  file.icc_name = profile_name(icc);
  if (std::memcmp(icc.data() + kSpaceAt, "RGB ", 4) == 0) file.icc = std::move(icc);
}

const PictureFileReader kPngReader{"PNG", is_png, list_png, read_png};
const PictureFileReader kJpegReader{"JPEG", begins_as_jpeg, list_jpeg, read_jpeg};

}  // namespace softfocus

#include "tools/pictures/image_file.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iostream>
#include <limits>
#include <string>
#include <system_error>

#include "raster/images/texel.h"
#include "raster/numbers/exact_math.h"
#include "raster/numbers/half.h"
#include "tools/cli/errors.h"
#include "tools/cli/platform.h"
#include "tools/pictures/exr_file.h"
#include "tools/pictures/picture_file.h"
#include "tools/pictures/png_text.h"

namespace softfocus {
namespace {

bool starts_with(std::span<const std::byte> bytes, std::string_view start) {
  return bytes.size() >= start.size() && std::memcmp(bytes.data(), start.data(), start.size()) == 0;
}

struct NamedFormat {
  std::string_view name;
  FileFormat format;
};
constexpr std::array kFormats{NamedFormat{"png", FileFormat::png},
                              NamedFormat{"png-16", FileFormat::png_16},
                              NamedFormat{"pfm", FileFormat::pfm},
                              NamedFormat{"npy", FileFormat::npy},
                              NamedFormat{"hdr", FileFormat::hdr},
                              NamedFormat{"exr", FileFormat::exr},
                              NamedFormat{"exr-float", FileFormat::exr_float},
                              NamedFormat{"tiff", FileFormat::tiff},
                              NamedFormat{"rgb24", FileFormat::rgb24},
                              NamedFormat{"rgb48le", FileFormat::rgb48le}};

}  // namespace

std::optional<FileFormat> format_by_name(std::string_view name) {
  for (const NamedFormat& known : kFormats) {
    if (known.name == name) return known.format;
  }
  return std::nullopt;
}

std::string format_names(std::string_view between) {
  std::string names;
  for (const NamedFormat& known : kFormats) {
    names += (names.empty() ? "" : std::string{between}) + std::string{known.name};
  }
  return names;
}

std::string_view missing_format(FileFormat format) {
  if (format == FileFormat::tiff) return missing_tiff();
  return format == FileFormat::exr || format == FileFormat::exr_float ? missing_exr()
                                                                      : std::string_view{};
}

bool is_raw_video(FileFormat format) {
  return format == FileFormat::rgb24 || format == FileFormat::rgb48le;
}

std::optional<FileFormat> format_by_extension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  if (extension.empty()) return std::nullopt;
  extension.erase(0, 1);
  for (char& c : extension) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  const auto format = format_by_name(extension == "tif" ? "tiff" : extension);
  return format && is_raw_video(*format) ? std::nullopt : format;
}

Bytes encode(const Image& image, FileFormat format) {
  switch (format) {
    case FileFormat::png: return encode_png(image);
    case FileFormat::png_16: return encode_png_16(image);
    case FileFormat::pfm: return encode_pfm(image);
    case FileFormat::npy: return encode_npy(image);
    case FileFormat::hdr: return encode_hdr(image);
    case FileFormat::exr: return encode_exr(image, ExrNumbers::half, "");
    case FileFormat::exr_float: return encode_exr(image, ExrNumbers::single, "");
    case FileFormat::tiff: return encode_tiff(image);
    case FileFormat::rgb24: return encode_rgb24(image);
    case FileFormat::rgb48le: return encode_rgb48le(image);
  }
  return {};
}

Bytes encode_depth(std::span<const float> metres, int width, int height, FileFormat format) {
  switch (format) {
    case FileFormat::png:
    case FileFormat::png_16: {
      std::vector<std::uint16_t> millimetres(metres.size());
      std::transform(metres.begin(), metres.end(), millimetres.begin(), [](float metre) {
        const double value = 1000.0 * static_cast<double>(metre) + 0.5;
        return static_cast<std::uint16_t>(value >= 1.0 && value < 65536.0 ? value : 0.0);
      });
      return encode_grey_png_16(millimetres, width, height);
    }
    case FileFormat::pfm: return encode_grey_pfm(metres, width, height);
    case FileFormat::npy: return encode_grey_npy(metres, width, height);
    case FileFormat::exr:
    case FileFormat::exr_float: return encode_depth_exr(metres, width, height);
    default: break;
  }
  throw FileError("such a file has no depth; give a .pfm, .exr, .npy or .png file");
}

Picture decode(std::span<const std::byte> bytes, FileFormat format) {
  switch (format) {
    case FileFormat::png: return decode_png(bytes);
    case FileFormat::pfm: return decode_pfm(bytes);
    case FileFormat::npy: return decode_npy(bytes);
    default: return decode_other(bytes, "the picture");
  }
}

Picture decode_other(std::span<const std::byte> bytes, const std::filesystem::path& path) {
  const PictureFile file = open_picture_file({bytes.begin(), bytes.end()}, path);
  const auto layers = colour_layers(file);
  if (layers.empty()) {
    throw FileError("cannot read '" + path.string() + "': there is no colour in it, but " +
                    plane_names(file));
  }
  Picture picture = read_colour(file, layers.front(), true);
  const auto depth = std::find_if(file.planes.begin(), file.planes.end(),
                                  [](const PlaneInfo& plane) { return plane.name == "Z"; });
  if (depth == file.planes.end()) return picture;
  const std::array planes{static_cast<std::size_t>(depth - file.planes.begin())};
  put_in_alpha(read_planes(file, planes, 0.0f)[0], picture.image);
  picture.has_alpha = true;
  return picture;
}

namespace {

/// Half of the machine's memory; 16 GB where the system does not tell.
std::size_t most_picture_bytes() {
  const std::uint64_t most = memory_bytes().value_or(std::uint64_t{1} << 35) / 2;
  // On 32 bits a buffer of more could not grow.
  return static_cast<std::size_t>(
      std::min<std::uint64_t>(most, std::numeric_limits<std::size_t>::max() / 4));
}

}  // namespace

Bytes read_picture_bytes(const std::filesystem::path& file) {
  const auto refuse = [&](int error) {
    throw FileError("cannot read '" + file.string() +
                    "': " + std::generic_category().message(error) + "; give a picture's file");
  };
  std::ifstream from_file;
  if (file != "-") {
    if (std::filesystem::is_directory(file)) refuse(EISDIR);
    from_file.open(file, std::ios::binary);
    if (!from_file) refuse(errno);
  }
  std::istream& stream = file == "-" ? std::cin : from_file;
  Bytes bytes;
  for (;;) {
    constexpr std::size_t kPart = 1 << 20;
    const std::size_t before = bytes.size();
    bytes.resize(before + kPart);
    stream.read(reinterpret_cast<char*>(bytes.data() + before), kPart);
    bytes.resize(before + static_cast<std::size_t>(stream.gcount()));
    if (stream.bad()) refuse(EIO);
    // The first part is enough to refuse a file that is no picture: it may have no end.
    if (!stream || !begins_as_picture(bytes)) return bytes;
    // A device that begins as a picture need not end either.
    const std::size_t most = most_picture_bytes();
    if (bytes.size() > most) {
      throw FileError("cannot read '" + file.string() + "': has more than " + std::to_string(most) +
                      " bytes; give a smaller file");
    }
  }
}

Picture decode_picture(std::span<const std::byte> bytes, const std::filesystem::path& file) {
  try {
    if (is_png(bytes)) return decode_png(bytes);
    if (starts_with(bytes, "\x93NUMPY")) return decode_npy(bytes);
    if (starts_with(bytes, "PF")) return decode_pfm(bytes);
  } catch (const FileError& error) {
    throw FileError("cannot read '" + file.string() + "': " + error.what());
  }
  return decode_other(bytes, file);
}

void clear_alpha(Image& image) {
  for (int y = 0; y < image.height; ++y) {
    const auto values = row<std::uint16_t>(image, y);
    for (std::size_t i = 3; i < values.size(); i += 4) values[i] = 0;
  }
}

Picture read_image_file(const std::filesystem::path& file) {
  return decode_picture(read_picture_bytes(file), file);
}

float srgb16_to_linear(std::uint16_t encoded) {
  const double v = encoded / 65535.0;
  return static_cast<float>(v <= 0.04045 ? v / 12.92 : exact_math::pow((v + 0.055) / 1.055, 2.4));
}

std::vector<std::uint16_t> srgb16_of_halves() {
  std::vector<std::uint16_t> encoded(65536, 0);
  for (std::uint32_t bits = 0; bits <= kHalfInfinity; ++bits) {  // negative ones and NaN stay 0
    if (bits >= kHalfOne) {
      encoded[bits] = 65535;
      continue;
    }
    const double linear = static_cast<double>(half_to_float(static_cast<std::uint16_t>(bits)));
    const double v =
        linear <= 0.0031308 ? 12.92 * linear : 1.055 * exact_math::pow(linear, 1.0 / 2.4) - 0.055;
    encoded[bits] = static_cast<std::uint16_t>(v * 65535.0 + 0.5);
  }
  return encoded;
}

// A picture's colours in the sRGB curve and nothing else, as programs take them for a video.

namespace {

/// Fills the codes of halves between two whose codes are known: most neighbours have the same.
void fill_codes(std::array<std::uint8_t, 65536>& codes, std::size_t low, std::size_t high) {
  if (codes[low] == codes[high]) {
    std::fill(codes.begin() + static_cast<std::ptrdiff_t>(low),
              codes.begin() + static_cast<std::ptrdiff_t>(high), codes[low]);
  } else if (high - low > 1) {
    const std::size_t middle = (low + high) / 2;
    codes[middle] = linear_to_srgb8(half_to_float(static_cast<std::uint16_t>(middle)));
    fill_codes(codes, low, middle);
    fill_codes(codes, middle, high);
  }
}

}  // namespace

const std::array<std::uint8_t, 65536>& srgb8_of_halves() {
  static const auto codes = [] {
    std::array<std::uint8_t, 65536> filled{};  // negative ones and NaN stay 0
    filled[kHalfInfinity] = 255;
    fill_codes(filled, 0, kHalfInfinity);
    return filled;
  }();
  return codes;
}

Bytes encode_rgb24(const Image& image) {
  Bytes bytes;
  bytes.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 3);
  const auto& encoded = srgb8_of_halves();
  for (int y = 0; y < image.height; ++y) {
    const auto halves = row<std::uint16_t>(image, y);
    for (std::size_t i = 0; i < halves.size(); i += 4) {
      for (std::size_t c = 0; c < 3; ++c) bytes.push_back(std::byte{encoded[halves[i + c]]});
    }
  }
  return bytes;
}

Bytes encode_rgb48le(const Image& image) {
  const std::vector<std::uint16_t> encoded = srgb16_of_halves();
  Bytes bytes;
  bytes.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 6);
  for (int y = 0; y < image.height; ++y) {
    const auto halves = row<std::uint16_t>(image, y);
    for (std::size_t i = 0; i < halves.size(); ++i) {
      if (i % 4 == 3) continue;
      const std::uint16_t value = encoded[halves[i]];
      bytes.push_back(static_cast<std::byte>(value & 0xFF));
      bytes.push_back(static_cast<std::byte>(value >> 8));
    }
  }
  return bytes;
}

}  // namespace softfocus

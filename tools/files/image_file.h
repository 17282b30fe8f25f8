#pragma once
// RGBA16F images as files: PNG to look at, PFM for linear colour, NPY for every bit.
//
//   PNG   RGB, 8 bits, sRGB; alpha (the depth) is left out
//   PFM   RGB, binary32, linear, little-endian (scale -1.0), bottom row first
//   NPY   version 1.0, '<f2', shape (height, width, 4): the image's own bits

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "raster/images/image.h"

namespace softfocus {

enum class FileFormat : std::uint8_t { png, pfm, npy };

using Bytes = std::vector<std::byte>;

/// The format that a name asks for (png, pfm or npy; as an extension, any case).
std::optional<FileFormat> format_by_name(std::string_view name);
std::optional<FileFormat> format_by_extension(const std::filesystem::path& file);

/// A picture as read. Without alpha in the file, alpha is 0 here.
struct Picture {
  Image image;  ///< RGBA16F
  bool has_alpha = false;
};

/// An RGBA16F image as the bytes of a file, the same on every machine.
Bytes encode(const Image& image, FileFormat format);
Bytes encode_png(const Image& image);
Bytes encode_pfm(const Image& image);
/// Takes every format, value by value as it is: (height, width, channels) of bytes, halves or
/// binary32. decode_npy() reads halves and binary32 of 3 or 4 channels.
Bytes encode_npy(const Image& image);

/// The way back. Throws FileError with what is wrong, the file itself unnamed.
///
/// PNG: 8 bits a channel, through the sRGB table and rounded to nearest half, which
/// keeps all 256 values apart; alpha is linear. PFM: colour, either byte order. NPY:
/// versions 1.0 and 2.0, '<f2' or '<f4', C order, (height, width, 3 or 4).
/// binary32 values are rounded to the nearest half.
Picture decode(std::span<const std::byte> bytes, FileFormat format);
Picture decode_png(std::span<const std::byte> bytes);
Picture decode_pfm(std::span<const std::byte> bytes);
Picture decode_npy(std::span<const std::byte> bytes);

/// The bytes of a picture's file, and the picture in them, of any of the formats, told by the first
/// bytes. FileError names the file.
Bytes read_picture_bytes(const std::filesystem::path& file);
Picture decode_picture(std::span<const std::byte> bytes, const std::filesystem::path& file);

/// Both.
Picture read_image_file(const std::filesystem::path& file);

}  // namespace softfocus

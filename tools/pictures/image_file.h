#pragma once
// RGBA16F images as files: PNG to look at, PFM, HDR and EXR for linear colour, NPY for every bit.
//
//   PNG   RGB, 8 or 16 bits, sRGB; alpha (the depth) is left out
//   PFM   RGB, binary32, linear, little-endian (scale -1.0), bottom row first
//   HDR   Radiance's RGBE, linear
//   EXR   R, G, B in halves or floats, linear, and the depth as the float channel Z (exr_file.h)
//   NPY   version 1.0, '<f2', shape (height, width, 4): the image's own bits
//   RGB24, RGB48LE   raw video, as ffmpeg names it: a PNG's colours, row by row, nothing else

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "raster/images/image.h"
#include "raster/threads/parallel.h"

namespace softfocus {

enum class FileFormat : std::uint8_t {
  png,
  png_16,
  pfm,
  npy,
  hdr,
  exr,
  exr_float,
  tiff,
  rgb24,
  rgb48le
};

using Bytes = std::vector<std::byte>;

/// The format that a name asks for: one of format_names(). As an extension, in any case: png, pfm,
/// npy, hdr, exr, tiff or tif.
std::optional<FileFormat> format_by_name(std::string_view name);
/// "png, png-16, pfm, npy, hdr, exr, exr-float, tiff, rgb24, rgb48le"; with another text between
/// them.
std::string format_names(std::string_view between = ", ");
/// Why this build cannot write it, as a sentence; empty if it can.
std::string_view missing_format(FileFormat format);
/// Whether it is colours alone, one frame after the other.
bool is_raw_video(FileFormat format);
std::optional<FileFormat> format_by_extension(const std::filesystem::path& file);

/// A picture as read. Without alpha in the file, alpha is 0 here.
struct Picture {
  Image image;  ///< RGBA16F
  bool has_alpha = false;
  int light_power = 0;     ///< colours are to be multiplied by 2^light_power
  double brightest = 0.0;  ///< finite colour of the file, if it has floats
  std::size_t cut = 0;     ///< values that even so are cut to the largest half
};

/// As of a file without alpha.
void clear_alpha(Image& image);

/// Colours beyond 65504, the largest half, are divided by a power of two before they become halves
/// and multiplied again when they are written. That keeps all bits of those from 2^(power - 14) on;
/// darker ones are known to 2^(power - 25), which with the largest power is 3e-5.
inline constexpr int kMostLightPower = 10;

/// An RGBA16F image as the bytes of a file, the same on every machine; of what is compressed, its
/// values are.
Bytes encode(const Image& image, FileFormat format);
/// `alpha`, if any, has a number from 0 to 1 for each pixel, by which its colour was multiplied:
/// the file then has RGBA, with colours that are not. `pool`, if any, filters rows.
Bytes encode_png(const Image& image, std::span<const float> alpha = {}, ThreadPool* pool = nullptr);
Bytes encode_png_16(const Image& image, std::span<const float> alpha = {});
/// Whole numbers of 16 bits along the sRGB curve, red, green, blue of each pixel, and alpha if
/// there is any, by which colours are divided.
std::vector<std::uint16_t> srgb16_values(const Image& image, std::span<const float> alpha = {});
/// Those in a TIFF that is not compressed, with a profile of the colours. Throws FileError.
Bytes encode_tiff(const Image& image, std::span<const float> alpha = {},
                  std::span<const std::byte> icc = {});
Bytes encode_rgb24(const Image& image);
/// Each number's low byte first.
Bytes encode_rgb48le(const Image& image);
/// `light`: colours are multiplied by it.
Bytes encode_hdr(const Image& image, float light = 1.0f);
Bytes encode_pfm(const Image& image, float light = 1.0f);
/// Takes every format, value by value as it is: (height, width, channels) of bytes, halves or
/// binary32. decode_npy() reads halves and binary32 of 3 or 4 channels.
Bytes encode_npy(const Image& image);

/// One plane of numbers, row by row from the top: a depth in metres. PNG has 16 bits grey, whole
/// millimetres: 0 for what is NaN, infinite or not within 1 to 65535. PFM ('Pf') and NPY ('<f4',
/// (height, width)) have the floats, EXR too, as its channel Z. Not HDR, which has no grey.
Bytes encode_depth(std::span<const float> metres, int width, int height, FileFormat format);
Bytes encode_grey_png_16(std::span<const std::uint16_t> values, int width, int height);
Bytes encode_grey_pfm(std::span<const float> values, int width, int height);
Bytes encode_grey_npy(std::span<const float> values, int width, int height);

/// The way back. Throws FileError with what is wrong, the file itself unnamed.
///
/// PNG: 8 and 16 bits a channel, through the sRGB curve and rounded to nearest half, which
/// keeps all 256 values of 8 bits apart; alpha is linear. PFM: colour, either byte order. NPY:
/// as picture_file.h says, halves bit by bit. Other values are rounded to the nearest half.
Picture decode(std::span<const std::byte> bytes, FileFormat format);
Picture decode_png(std::span<const std::byte> bytes);
Picture decode_pfm(std::span<const std::byte> bytes);
Picture decode_npy(std::span<const std::byte> bytes);
/// Decodes any kind, by the first bytes. FileError names `path`.
Picture decode_other(std::span<const std::byte> bytes, const std::filesystem::path& path);

/// The bytes of a picture's file, and the picture in them, of any kind that picture_file.h reads,
/// told by the first bytes; of an EXR its first colour, with Z in alpha. "-" is standard input,
/// which can be read once; a file of that name is "./-". FileError names the file, also for one of
/// more bytes than half of the machine's memory: a device need not end.
Bytes read_picture_bytes(const std::filesystem::path& file);
Picture decode_picture(std::span<const std::byte> bytes, const std::filesystem::path& file);

/// Both.
Picture read_image_file(const std::filesystem::path& file);

// The sRGB curve in 16 bits, as PNG has it (IEC 61966-2-1), and from halves.

/// Linear light; 0 to 65535 stand for 0 to 1.
float srgb16_to_linear(std::uint16_t encoded);

/// For every half's bits the number that encodes it, 0 to 65535: values outside of 0 to 1 are cut,
/// NaN is 0.
std::vector<std::uint16_t> srgb16_of_halves();
/// The same in 8 bits: linear_to_srgb8().
const std::array<std::uint8_t, 65536>& srgb8_of_halves();

}  // namespace softfocus

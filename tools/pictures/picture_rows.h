#pragma once
// A picture's file that is written while the picture is made, a band of rows at a time from the top
// down, and has the bytes that encode() gives of the whole one. PNG is written whole alone: stb
// compresses all of it at once.

#include <functional>
#include <string>

#include "tools/pictures/exr_file.h"
#include "tools/pictures/picture_file.h"

namespace softfocus {

/// Whether write_picture_rows() knows the format.
bool is_written_by_rows(FileFormat format);

/// Rows of a picture, in memory that is the maker's until its next call.
struct PictureBand {
  ConstImageView picture;                                 ///< RGBA16F
  std::span<const float> alpha{}, depth_m{}, radii_px{};  ///< as in PictureExtras
};

/// Makes the next rows. They come in order and without gaps.
using MakeBand = std::function<PictureBand(Rows rows)>;

/// Takes bytes at a place of the file; a later call may change what an earlier one wrote.
using WriteAt = std::function<void(std::uint64_t place, std::span<const std::byte> bytes)>;

/// A picture whose rows are made while it is written.
struct PictureToWrite {
  int width = 0;   ///< 1 to kMaxImageSize
  int height = 0;  ///< 1 to kMostRows
  MakeBand make;
  std::string notes{};                         ///< of an EXR; or empty
  std::function<std::string()> notes_after{};  ///< what takes their place at the end, as long
};

/// PFM, NPY, HDR, EXR. Only the lens, the source and the kept planes of `extras` are used; an EXR
/// has alpha, depth and radii if the spans there are not empty, whatever they point to.
void write_picture_rows(const PictureToWrite& picture, FileFormat format,
                        const PictureExtras& extras, const WriteAt& write);

/// The bytes before the rows of a file of `height` of them, and rows, in the file's order.
Bytes npy_start(const ConstImageView& image, int height);
void append_npy_rows(Bytes& bytes, const ConstImageView& image);
Bytes pfm_start(int width, int height);
/// The lowest first; colours times `light`.
void append_pfm_rows(Bytes& bytes, const ConstImageView& image, float light = 1.0f);
Bytes hdr_start(int width, int height);
void append_hdr_rows(Bytes& bytes, const ConstImageView& image, float light = 1.0f);

/// Throws FileError.
void write_exr(const PictureToWrite& picture, ExrNumbers numbers, const PictureExtras& extras,
               const WriteAt& write);

}  // namespace softfocus

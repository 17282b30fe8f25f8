#include "tools/pictures/picture_rows.h"

#include <algorithm>

#include "tools/pictures/picture_notes.h"

namespace softfocus {
namespace {

constexpr int kBandRows = 64;

void write_pfm(const PictureToWrite& picture, const WriteAt& write) {
  const Bytes start = pfm_start(picture.width, picture.height);
  write(0, start);
  Bytes bytes;
  for (int y = 0; y < picture.height; y += kBandRows) {
    const int rows = std::min(kBandRows, picture.height - y);
    bytes.clear();
    append_pfm_rows(bytes, picture.make({y, rows}).picture);
    const std::uint64_t row_bytes = bytes.size() / static_cast<std::size_t>(rows);
    write(start.size() + static_cast<std::uint64_t>(picture.height - y - rows) * row_bytes, bytes);
  }
}

/// Rows one behind the other.
void write_in_order(const PictureToWrite& picture, Bytes bytes, const WriteAt& write,
                    void (*append)(Bytes& bytes, const ConstImageView& image)) {
  std::uint64_t place = 0;
  for (int y = 0; y < picture.height; y += kBandRows) {
    append(bytes, picture.make({y, std::min(kBandRows, picture.height - y)}).picture);
    write(place, bytes);
    place += bytes.size();
    bytes.clear();
  }
}

}  // namespace

bool is_written_by_rows(FileFormat format) {
  return needs_sidecar(format) || format == FileFormat::exr || format == FileFormat::exr_float;
}

void write_picture_rows(const PictureToWrite& picture, FileFormat format,
                        const PictureExtras& extras, const WriteAt& write) {
  switch (format) {
    case FileFormat::pfm: return write_pfm(picture, write);
    case FileFormat::npy:
      return write_in_order(
          picture,
          npy_start(ConstImageView{.format = Format::rgba16f, .width = picture.width},
                    picture.height),
          write, append_npy_rows);
    case FileFormat::hdr:
      return write_in_order(
          picture, hdr_start(picture.width, picture.height), write,
          [](Bytes& bytes, const ConstImageView& image) { append_hdr_rows(bytes, image); });
    default:
      return write_exr(picture, format == FileFormat::exr ? ExrNumbers::half : ExrNumbers::single,
                       extras, write);
  }
}

}  // namespace softfocus

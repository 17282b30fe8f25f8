// Any bytes as a picture of one kind: a picture with its notes, or the error that is meant for the
// user.

#include <cstring>
#include <vector>

#include "tests/fuzz/fuzz_input.h"
#include "tools/cli/errors.h"
#include "tools/files/byte_order.h"
#include "tools/pictures/picture_file.h"
#include "tools/pictures/picture_notes.h"
#include "tools/pictures/png_text.h"

namespace {

using namespace softfocus;

/// Larger pictures cost time and find nothing that these do not.
constexpr std::int64_t kMostPicturePixels = 1 << 16;

/// Gives each chunk of a PNG its checksum, which no change by chance would meet.
Bytes with_checksums(const Bytes& png) {
  constexpr std::size_t kFrame = 12;
  std::span<const std::byte> rest{png};
  if (rest.size() < kPngSignature.size()) return png;
  Bytes mended{rest.begin(), rest.begin() + kPngSignature.size()};
  rest = rest.subspan(kPngSignature.size());
  while (rest.size() >= kFrame) {
    const std::size_t length = big_endian<std::uint32_t>(rest);
    if (length > rest.size() - kFrame) break;
    const auto* text = reinterpret_cast<const char*>(rest.data());
    append_png_chunk(mended, {text + 4, 4}, {text + 8, length});
    rest = rest.subspan(kFrame + length);
  }
  mended.insert(mended.end(), rest.begin(), rest.end());
  return mended;
}

void read_lower_half(const PictureFile& file) {
  const Rows lower_half{file.height / 2, file.height - file.height / 2};
  std::vector<PlaneValues> values(1);
  values[0].resize(static_cast<std::size_t>(file.width) *
                   static_cast<std::size_t>(lower_half.count));
  rows_of(file, {0})(lower_half, values);
}

void read_all(const PictureFileReader& reader, const Bytes& bytes) {
  const PictureFile file = open_picture_file(bytes, "fuzz");
  demand(file.reader == &reader && file.width >= 1 && file.height >= 1);
  if (std::int64_t{file.width} * file.height > kMostPicturePixels) return;
  const auto pixels = static_cast<std::size_t>(file.width) * static_cast<std::size_t>(file.height);
  for (std::size_t i = 0; i < file.planes.size() && i < 8; ++i) {
    demand(read_planes(file, {&i, 1}, 0.0f)[0].size() == pixels);
  }
  if (file.reader->rows != nullptr && file.has_rows && !file.planes.empty()) read_lower_half(file);
  for (const ColourLayer& layer : colour_layers(file)) read_colour(file, layer, true);
  decode_picture(bytes, "fuzz");
  if (is_png(bytes) || is_exr(bytes)) find_notes("fuzz", bytes);
}

}  // namespace

int softfocus::fuzz_picture(const PictureFileReader& reader, const std::uint8_t* data,
                            std::size_t size) {
  const auto* start = reinterpret_cast<const std::byte*>(data);
  Bytes bytes{start, start + size};
  if (!reader.is(bytes)) return -1;
  if (is_png(bytes)) bytes = with_checksums(bytes);
  try {
    read_all(reader, bytes);
    return counted(true, data, size);
  } catch (const FileError&) {
    return counted(false, data, size);
  }
}

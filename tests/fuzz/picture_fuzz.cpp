// Any bytes as each kind of picture, and as a shard's sums: a picture, or the error that is meant
// for the user.

#include "scenes/load/scene_error.h"
#include "scenes/load/texture_file.h"
#include "tests/fuzz/fuzz_input.h"
#include "tools/cli/errors.h"
#include "tools/files/image_file.h"
#include "tools/files/picture_file.h"
#include "tools/files/sums_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace softfocus;
  const std::span bytes{reinterpret_cast<const std::byte*>(data), size};
  for (const FileFormat format : {FileFormat::png, FileFormat::pfm, FileFormat::npy}) {
    try {
      decode(bytes, format);
    } catch (const FileError&) {
    }
  }
  try {
    const PictureFile file = open_picture_file({bytes.begin(), bytes.end()}, "fuzz");
    for (std::size_t i = 0; i < file.planes.size() && i < 4; ++i) read_planes(file, {&i, 1}, 0.0f);
    if (file.reader->rows != nullptr && file.has_rows && !file.planes.empty()) {
      const Rows lower_half{file.height / 2, file.height - file.height / 2};
      std::vector<PlaneValues> values(1);
      values[0].resize(static_cast<std::size_t>(file.width) *
                       static_cast<std::size_t>(lower_half.count));
      rows_of(file, {0})(lower_half, values);
    }
  } catch (const FileError&) {
  }
  try {
    check_sums_file(open_sums_file(fuzz_file(data, size, ".sum")));
  } catch (const FileError&) {
  }
  try {
    load_texture(fuzz_file(data, size, ".png"));
  } catch (const SceneError&) {
  }
  return 0;
}

// For builds without the OpenEXR library.

#include "tools/cli/errors.h"
#include "tools/files/exr_file.h"
#include "tools/files/picture_rows.h"

namespace softfocus {
namespace {

[[noreturn]] void refuse() { throw FileError(std::string{missing_exr()}); }

void list_exr(PictureFile&) { refuse(); }
void read_exr(const PictureFile&, std::span<const std::size_t>, std::span<PlaneValues>) {
  refuse();
}

}  // namespace

std::string_view missing_exr() {
  return "this build has no OpenEXR; install the library (libopenexr-dev) and build again";
}

Bytes encode_exr(const Image&, ExrNumbers, const std::string&, const PictureExtras&) { refuse(); }
Bytes encode_depth_exr(std::span<const float>, int, int) { refuse(); }
void write_exr(const PictureToWrite&, ExrNumbers, const PictureExtras&, const WriteAt&) {
  refuse();
}
std::optional<std::string> find_exr_notes(const ByteSource&) { return std::nullopt; }

const PictureFileReader kExrReader{"OpenEXR", is_exr, list_exr, read_exr};

}  // namespace softfocus

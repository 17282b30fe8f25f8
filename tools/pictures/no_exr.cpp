// For builds without the OpenEXR library.

#include "tools/cli/errors.h"
#include "tools/pictures/exr_file.h"
#include "tools/pictures/picture_rows.h"

namespace softfocus {
namespace {

[[noreturn]] void refuse() { throw FileError(std::string{missing_exr()}); }

void list_exr(PictureFile&) { refuse(); }
void read_exr(const PictureFile&, std::span<const std::size_t>, std::span<PlaneValues>) {
  refuse();
}

}  // namespace

std::string_view missing_exr() {
#ifdef __EMSCRIPTEN__
  return "no browser reads OpenEXR here; softfocus refocus IN.exr --method pinhole -o OUT.npy "
         "makes "
         "a NumPy file of its colour and depth";
#else
  return "this build has no OpenEXR; install the library (libopenexr-dev) and build again";
#endif
}

Bytes encode_exr(const Image&, ExrNumbers, const std::string&, const PictureExtras&,
                 const std::function<std::string()>&) {
  refuse();
}
Bytes encode_depth_exr(std::span<const float>, int, int) { refuse(); }
void write_exr(const PictureToWrite&, ExrNumbers, const PictureExtras&, const WriteAt&) {
  refuse();
}
std::optional<std::string> find_exr_notes(const ByteSource&) { return std::nullopt; }
HeaderLens find_exr_lens(const ByteSource&) { return {}; }

const PictureFileReader kExrReader{"OpenEXR", is_exr, list_exr, read_exr};

}  // namespace softfocus

#include "scenes/files/file_bytes.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include "scenes/files/scene_error.h"

namespace softfocus {

std::string read_file_bytes(const std::filesystem::path& file, std::size_t largest) {
  const auto fail = [&](const std::string& reason) {
    throw SceneError(file.string() + ": " + reason);
  };
  std::error_code unknown;
  // A stream opens a directory without complaint, and reads nothing from it.
  if (std::filesystem::is_directory(file, unknown)) fail("is a directory; give a file in it");
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    fail(errno == ENOENT || errno == 0 ? "no such file; check the path"
                                       : std::string("cannot be read: ") + std::strerror(errno));
  }

  // In pieces, as a pipe or a device does not know its size.
  constexpr std::size_t kPiece = std::size_t{1} << 20;
  std::string bytes;
  while (stream) {
    const std::size_t before = bytes.size();
    if (before > largest) {
      fail("has more than " + std::to_string(largest) + " bytes; a smaller file would do");
    }
    bytes.resize(before + kPiece);
    stream.read(bytes.data() + before, static_cast<std::streamsize>(kPiece));
    bytes.resize(before + static_cast<std::size_t>(stream.gcount()));
  }
  if (stream.bad()) fail("cannot be read to its end");
  return bytes;
}

void* zeroed_memory(std::size_t size) { return std::calloc(1, size); }

}  // namespace softfocus

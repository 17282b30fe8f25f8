#include "scenes/files/png_check.h"

#include <cstddef>
#include <cstdint>

// A PNG (PNG specification, 5.2 and 5.3) is a signature of 8 bytes and chunks: a big-endian length,
// a type of 4 letters, so many bytes, and a checksum of 4.

namespace softfocus {

bool has_cut_png_chunk(std::string_view bytes) {
  constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";
  constexpr std::size_t kFrame = 12;
  if (!bytes.starts_with(kSignature)) return false;
  for (bytes.remove_prefix(kSignature.size()); bytes.size() >= kFrame;) {
    std::uint32_t length = 0;
    for (const char byte : bytes.substr(0, 4)) {
      length = length << 8 | static_cast<unsigned char>(byte);
    }
    if (length > bytes.size() - kFrame) return true;
    if (bytes.substr(4, 4) == "IEND") return false;
    bytes.remove_prefix(kFrame + length);
  }
  return true;
}

}  // namespace softfocus

#include "scenes/files/file_bytes.h"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string_view>

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

  // In pieces, as a pipe or a device does not know its size. A file is one, with a byte more that
  // tells its end.
  constexpr std::size_t kPiece = std::size_t{1} << 20;
  std::size_t piece = kPiece;
  const std::uintmax_t size = std::filesystem::file_size(file, unknown);
  if (!unknown && size > 0 && size <= largest) piece = static_cast<std::size_t>(size) + 1;
  std::string bytes;
  while (stream) {
    const std::size_t before = bytes.size();
    if (before > largest) {
      fail("has more than " + std::to_string(largest) + " bytes; a smaller file would do");
    }
    bytes.resize(before + piece);
    stream.read(bytes.data() + before, static_cast<std::streamsize>(piece));
    bytes.resize(before + static_cast<std::size_t>(stream.gcount()));
    piece = kPiece;
  }
  if (stream.bad()) fail("cannot be read to its end");
  return bytes;
}

namespace {

void append_utf8(std::string& text, std::uint32_t code) {
  const auto put = [&](std::uint32_t byte) { text.push_back(static_cast<char>(byte)); };
  if (code < 0x80) return put(code);
  if (code < 0x800) {
    put(0xC0 | code >> 6);
  } else if (code < 0x10000) {
    put(0xE0 | code >> 12);
    put(0x80 | (code >> 6 & 0x3F));
  } else {
    put(0xF0 | code >> 18);
    put(0x80 | (code >> 12 & 0x3F));
    put(0x80 | (code >> 6 & 0x3F));
  }
  put(0x80 | (code & 0x3F));
}

/// Of UTF-16 after its mark; halves of a pair without the other become U+FFFD.
std::string utf8_of_utf16(std::string_view bytes, bool high_byte_first) {
  const auto unit = [&](std::size_t at) {
    const auto first = static_cast<unsigned char>(bytes[at]);
    const auto second = static_cast<unsigned char>(bytes[at + 1]);
    return std::uint32_t{high_byte_first ? first : second} << 8 |
           (high_byte_first ? second : first);
  };
  std::string text;
  for (std::size_t at = 0; at + 1 < bytes.size(); at += 2) {
    std::uint32_t code = unit(at);
    if (code >= 0xD800 && code < 0xE000) {
      const bool is_pair = code < 0xDC00 && at + 3 < bytes.size() && unit(at + 2) >> 10 == 0x37;
      if (is_pair) {
        code = 0x10000 + ((code & 0x3FF) << 10) + (unit(at + 2) & 0x3FF);
        at += 2;
      } else {
        code = 0xFFFD;
      }
    }
    append_utf8(text, code);
  }
  return text;
}

}  // namespace

void check_no_pipe(const std::filesystem::path& file) {
  std::error_code unknown;
  if (std::filesystem::exists(file, unknown) && !std::filesystem::is_directory(file, unknown) &&
      !std::filesystem::is_regular_file(file, unknown)) {
    throw SceneError(file.string() + ": is a pipe or a device; a file would be right");
  }
}

std::string read_file_text(const std::filesystem::path& file, std::size_t largest) {
  check_no_pipe(file);
  std::string text = read_file_bytes(file, largest);
  const std::string_view bytes = text;
  if (bytes.starts_with("\xEF\xBB\xBF")) return text.substr(3);
  if (bytes.starts_with("\xFF\xFE")) return utf8_of_utf16(bytes.substr(2), false);
  if (bytes.starts_with("\xFE\xFF")) return utf8_of_utf16(bytes.substr(2), true);
  return text;
}

bool has_extension(std::string_view path, std::string_view extension) {
  if (path.size() < extension.size()) return false;
  const std::string_view end = path.substr(path.size() - extension.size());
  return std::equal(end.begin(), end.end(), extension.begin(), [](char a, char b) {
    return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b;
  });
}

void* zeroed_memory(std::size_t size) { return std::calloc(1, size); }

}  // namespace softfocus

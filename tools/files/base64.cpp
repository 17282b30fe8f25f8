#include "tools/files/base64.h"

#include <cstdint>

namespace softfocus {

std::string base64(std::span<const std::byte> bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t there = bytes.size() - i < 3 ? bytes.size() - i : 3;
    std::uint32_t bits = 0;  // three bytes, the missing ones 0
    for (std::size_t k = 0; k < 3; ++k) {
      bits = bits << 8 | (k < there ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0u);
    }
    for (std::size_t digit = 0; digit < 4; ++digit) {
      text += digit <= there ? kDigits[bits >> (18 - 6 * digit) & 63u] : '=';
    }
  }
  return text;
}

std::vector<std::byte> bytes_of_base64(std::string_view text) {
  std::vector<std::byte> bytes;
  std::uint32_t bits = 0;  // of the digits so far, the last ones
  int waiting = 0;         // of these that are in no byte
  for (const char c : text) {
    const int digit = c >= 'A' && c <= 'Z'   ? c - 'A'
                      : c >= 'a' && c <= 'z' ? c - 'a' + 26
                      : c >= '0' && c <= '9' ? c - '0' + 52
                      : c == '+'             ? 62
                      : c == '/'             ? 63
                                             : -1;
    if (digit < 0) continue;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    waiting += 6;
    if (waiting < 8) continue;
    waiting -= 8;
    bytes.push_back(static_cast<std::byte>(bits >> waiting & 0xFFu));
  }
  return bytes;
}

}  // namespace softfocus

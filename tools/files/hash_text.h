#pragma once
// A hash as it is printed and kept: 0x and 16 digits.

#include <cstdint>
#include <cstdio>
#include <string>

namespace softfocus {

inline std::string hash_text(std::uint64_t hash) {
  char text[24];
  std::snprintf(text, sizeof text, "0x%016llx", static_cast<unsigned long long>(hash));
  return text;
}

}  // namespace softfocus

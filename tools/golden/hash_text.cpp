#include "tools/golden/hash_text.h"

#include <array>
#include <cstdio>

namespace softfocus {

std::string hash_text(std::uint64_t hash) {
  char text[24];
  std::snprintf(text, sizeof text, "0x%016llx", static_cast<unsigned long long>(hash));
  return text;
}

}  // namespace softfocus

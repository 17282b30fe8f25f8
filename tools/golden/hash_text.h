#pragma once
// A 64-bit hash as it is printed and kept.

#include <cstdint>
#include <string>

namespace softfocus {

/// 0x and 16 digits.
std::string hash_text(std::uint64_t hash);

}  // namespace softfocus

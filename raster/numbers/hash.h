#pragma once
// FNV-1a, 64 bits (Fowler, Noll and Vo): the fingerprint that the golden tables hold.
// Values are fed in little-endian byte order whatever the machine's own is.

#include <bit>
#include <cstdint>

namespace softfocus {

struct Hash {
  std::uint64_t value = 0xCBF29CE484222325u;
};

template <class Unsigned>
constexpr void add_to_hash(Hash& hash, Unsigned value) {
  for (std::size_t byte = 0; byte < sizeof(Unsigned); ++byte) {
    hash.value ^= static_cast<std::uint64_t>(value >> (8 * byte)) & 0xFFu;
    hash.value *= 0x100000001B3u;
  }
}

constexpr void add_to_hash(Hash& hash, float value) {
  add_to_hash(hash, std::bit_cast<std::uint32_t>(value));
}

}  // namespace softfocus

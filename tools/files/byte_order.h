#pragma once
// Numbers as bytes, least significant first, whatever the machine's own order.

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace softfocus {

template <std::unsigned_integral T>
void append_little_endian(std::vector<std::byte>& bytes, T value) {
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    bytes.push_back(static_cast<std::byte>(value >> (8 * i) & 0xFFu));
  }
}

/// Needs sizeof(T) bytes.
template <std::unsigned_integral T>
T little_endian(std::span<const std::byte> bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = sizeof(T); i-- > 0;) {
    value = value << 8 | std::to_integer<std::uint64_t>(bytes[i]);
  }
  return static_cast<T>(value);
}

template <std::unsigned_integral T>
T big_endian(std::span<const std::byte> bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    value = value << 8 | std::to_integer<std::uint64_t>(bytes[i]);
  }
  return static_cast<T>(value);
}

}  // namespace softfocus

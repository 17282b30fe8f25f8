#pragma once
// Equal things by one number, in linear time and in an order that no library decides.

#include <array>
#include <cstdint>
#include <unordered_map>
#include <utility>

#include "raster/numbers/random_bits.h"

namespace softfocus {

/// Numbers things in the order in which they come. Nothing ever goes through the hash
/// map in its own order, which differs between libraries.
class FirstComeNumbers {
 public:
  using Key = std::array<std::uint32_t, 3>;
  explicit FirstComeNumbers(std::size_t expected = 0) { numbers_.reserve(expected); }
  /// The key's number, and whether it is new.
  std::pair<std::uint32_t, bool> number(const Key& key) {
    const auto [entry, is_new] = numbers_.emplace(key, static_cast<std::uint32_t>(numbers_.size()));
    return {entry->second, is_new};
  }

 private:
  struct Mix {
    std::size_t operator()(const Key& key) const {
      const std::uint64_t low = static_cast<std::uint64_t>(key[0]) << 32 | key[1];
      return static_cast<std::size_t>(mix_bits(mix_bits(low) + key[2]));
    }
  };
  std::unordered_map<Key, std::uint32_t, Mix> numbers_;
};

}  // namespace softfocus

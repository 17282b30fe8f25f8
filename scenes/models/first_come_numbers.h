#pragma once
// Equal things by one number, in linear time and in an order that no library decides.

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "raster/numbers/random_bits.h"

namespace softfocus {

/// Numbers things in the order in which they come. Nothing ever goes through the hash
/// table in its own order.
class FirstComeNumbers {
 public:
  using Key = std::array<std::uint32_t, 3>;
  explicit FirstComeNumbers(std::size_t expected = 0) {
    keys_.reserve(expected);
    while (slots_.size() < 2 * expected) slots_.resize(2 * slots_.size());
  }
  /// The key's number, and whether it is new.
  std::pair<std::uint32_t, bool> number(const Key& key) {
    std::size_t slot = find(key);
    if (slots_[slot] != 0) return {slots_[slot] - 1, false};
    keys_.push_back(key);
    if (2 * keys_.size() > slots_.size()) {
      grow();
    } else {
      slots_[slot] = static_cast<std::uint32_t>(keys_.size());
    }
    return {static_cast<std::uint32_t>(keys_.size() - 1), true};
  }

 private:
  // The slot that has the key, or the free one where it belongs.
  std::size_t find(const Key& key) const {
    const std::uint64_t low = static_cast<std::uint64_t>(key[0]) << 32 | key[1];
    std::size_t slot = static_cast<std::size_t>(mix_bits(mix_bits(low) + key[2]));
    for (;; ++slot) {
      slot &= slots_.size() - 1;
      if (slots_[slot] == 0) return slot;
      const Key& there = keys_[slots_[slot] - 1];
      if (there[0] == key[0] && there[1] == key[1] && there[2] == key[2]) return slot;
    }
  }
  void grow() {
    slots_.assign(2 * slots_.size(), 0);
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      slots_[find(keys_[i])] = static_cast<std::uint32_t>(i + 1);
    }
  }

  std::vector<Key> keys_;  // by number
  // Numbers from 1; 0 is free. A power of two of slots, half of them free or more. A key whose
  // slot is taken lies in the next free one.
  std::vector<std::uint32_t> slots_ = std::vector<std::uint32_t>(16);
};

}  // namespace softfocus

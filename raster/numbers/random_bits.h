#pragma once
// Numbers that look random and are the same everywhere: splitmix64 (Steele, Lea and
// Flood 2014). The standard's distributions are not: each library has its own.

#include <cstdint>

namespace softfocus {

/// The finaliser of splitmix64: spreads every bit over all 64.
constexpr std::uint64_t mix_bits(std::uint64_t x) {
  x = (x ^ x >> 30) * 0xBF58476D1CE4E5B9u;
  x = (x ^ x >> 27) * 0x94D049BB133111EBu;
  return x ^ x >> 31;
}

/// The upper 53 bits as a number from 0 up to but not including 1; exact.
constexpr double unit_interval(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

struct RandomSequence {
  std::uint64_t state = 0;  ///< the seed, at first
};

constexpr std::uint64_t next_bits(RandomSequence& sequence) {
  sequence.state += 0x9E3779B97F4A7C15u;
  return mix_bits(sequence.state);
}

/// The next number from `low` up to `high`.
constexpr double next_between(RandomSequence& sequence, double low, double high) {
  return low + (high - low) * unit_interval(next_bits(sequence));
}

/// A hash of a place on a grid, such as a pixel: the finaliser of MurmurHash3 (Appleby).
constexpr std::uint32_t hash_of_place(int x, int y) {
  std::uint32_t hash =
      static_cast<std::uint32_t>(x) * 0x9E3779B9u ^ static_cast<std::uint32_t>(y) * 0x85EBCA77u;
  hash ^= hash >> 16;
  hash *= 0x85EBCA6Bu;
  hash ^= hash >> 13;
  hash *= 0xC2B2AE35u;
  return hash ^ hash >> 16;
}

}  // namespace softfocus

#pragma once
// The tests' source of chance: the same numbers on every machine.

#include <cstdint>

#include "raster/numbers/random_bits.h"

namespace softfocus::test {

struct Random {
  std::uint64_t state = 1;

  std::uint64_t next() {
    RandomSequence sequence{state};
    const std::uint64_t bits = next_bits(sequence);
    state = sequence.state;
    return bits;
  }
  /// 0 <= value < 1, a multiple of 2^-24.
  float unit() { return static_cast<float>(next() >> 40) * 0x1p-24f; }
  /// Uniform in [low, high), a multiple of 2^-53 of the width.
  double between(double low, double high) { return low + (high - low) * unit_interval(next()); }
  float between(float low, float high) {
    return static_cast<float>(between(static_cast<double>(low), static_cast<double>(high)));
  }
  /// low <= value <= high.
  int whole(int low, int high) {
    return low + static_cast<int>(next() % static_cast<std::uint64_t>(high - low + 1));
  }
};

}  // namespace softfocus::test

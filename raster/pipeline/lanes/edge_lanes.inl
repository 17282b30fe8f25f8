// Edge functions that 32 bits do not hold, in binary64: two vectors have the lanes of one.

namespace {

using HalfDoubles [[gnu::vector_size(4 * SOFTFOCUS_LANES)]] = double;
using HalfFloats [[gnu::vector_size(2 * SOFTFOCUS_LANES)]] = float;
using HalfInts [[gnu::vector_size(2 * SOFTFOCUS_LANES)]] = std::int32_t;

struct WideLanes {
  HalfDoubles low, high;

  // Friends are found by their operands alone, and so hide no other operators.
  SOFTFOCUS_INLINE friend WideLanes operator+(const WideLanes& a, const WideLanes& b) {
    return {a.low + b.low, a.high + b.high};
  }
  SOFTFOCUS_INLINE friend WideLanes operator*(const WideLanes& a, const WideLanes& b) {
    return {a.low * b.low, a.high * b.high};
  }
};

SOFTFOCUS_INLINE WideLanes wide_splat(double value) {
  return {HalfDoubles{} + value, HalfDoubles{} + value};
}

/// A number for each quad.
SOFTFOCUS_INLINE WideLanes wide_repeat(const std::array<double, kQuads>& v) {
#if SOFTFOCUS_LANES == 16
  const HalfDoubles low = {v[0], v[0], v[0], v[0], v[1], v[1], v[1], v[1]};
  const HalfDoubles high = {v[2], v[2], v[2], v[2], v[3], v[3], v[3], v[3]};
#else
  const HalfDoubles low = HalfDoubles{} + v[0];
  const HalfDoubles high = HalfDoubles{} + v[kQuads - 1];
#endif
  return {low, high};
}

template <std::size_t... lane>
SOFTFOCUS_INLINE WideLanes widen_lanes(Ints v, std::index_sequence<lane...>) {
  const HalfInts low = __builtin_shufflevector(v, v, lane...);
  const HalfInts high = __builtin_shufflevector(v, v, (lane + kLanes / 2)...);
  return {__builtin_convertvector(low, HalfDoubles), __builtin_convertvector(high, HalfDoubles)};
}
SOFTFOCUS_INLINE WideLanes widen(Ints v) {
  return widen_lanes(v, std::make_index_sequence<kLanes / 2>{});
}

template <std::size_t... lane>
SOFTFOCUS_INLINE Floats join_halves(HalfFloats low, HalfFloats high, std::index_sequence<lane...>) {
  return __builtin_shufflevector(low, high, lane...);
}
/// Rounded to nearest. The values are integers, so they stay on their side of 0 and 1.
SOFTFOCUS_INLINE Floats narrow(const WideLanes& v) {
  return join_halves(__builtin_convertvector(v.low, HalfFloats),
                     __builtin_convertvector(v.high, HalfFloats),
                     std::make_index_sequence<kLanes>{});
}

}  // namespace

// What the kernels of mip_levels.cpp and mipmap.cpp share.

#include "dof/picture_lanes.inl"

// Lanes 0, 2, 4, ... or 1, 3, 5, ... of two vectors.
template <std::size_t first, std::size_t... lane>
SOFTFOCUS_INLINE Floats every_other(Floats a, Floats b, std::index_sequence<lane...>) {
  return __builtin_shufflevector(a, b, (2 * lane + first)...);
}

// The sums of neighbours in two vectors side by side.
SOFTFOCUS_INLINE Floats add_pairs(Floats a, Floats b) {
  using Lanes = std::make_index_sequence<SOFTFOCUS_LANES>;
  return every_other<0>(a, b, Lanes{}) + every_other<1>(a, b, Lanes{});
}

// Lanes from `from` on, of `a` and `b` by turns.
template <std::size_t from, std::size_t... lane>
SOFTFOCUS_INLINE Floats by_turns(Floats a, Floats b, std::index_sequence<lane...>) {
  return __builtin_shufflevector(a, b, (from + lane / 2 + (lane & 1) * kLanes)...);
}

// How much of a square belongs to a rung and to larger ones.
SOFTFOCUS_INLINE Floats share_from(MipStep step, Floats square) {
  return saturate((square - step.begin) * step.slope);
}

// 2 kLanes pixels from rows of pixels of twice the size: three quarters of the row `inside` which
// they lie, a quarter of the `other`; along x likewise.
struct Enlarged {
  Floats lower, upper;
};
SOFTFOCUS_INLINE Enlarged enlarge(const float* inside, const float* other) {
  using Lanes = std::make_index_sequence<SOFTFOCUS_LANES>;
  const Floats own = 0.75f * (0.75f * load(inside) + 0.25f * load(other));
  const Floats left = 0.75f * load(inside - 1) + 0.25f * load(other - 1);
  const Floats right = 0.75f * load(inside + 1) + 0.25f * load(other + 1);
  const Floats even = own + 0.25f * left, odd = own + 0.25f * right;
  return {by_turns<0>(even, odd, Lanes{}), by_turns<kLanes / 2>(even, odd, Lanes{})};
}

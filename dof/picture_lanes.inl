// What the kernels of several methods share.

#include "dof/weights.inl"

SOFTFOCUS_INLINE Floats saturate(Floats v) { return larger(smaller(v, splat(1.0f)), splat(0.0f)); }

SOFTFOCUS_INLINE Floats mix(Floats a, Floats b, Floats share) { return a + share * (b - a); }

/// A NaN becomes black, an infinity the largest half.
SOFTFOCUS_INLINE Floats finite_colour(Bits half) {
  const Floats value = clamp_to_half(half_to_float(half));
  return select(value == value, value, splat(0.0f));
}

/// SplitTexel::radius_px of picture_planes.h.
SOFTFOCUS_INLINE Floats split_radius(const DofSettings& settings, Floats depth_m) {
  const Floats radius =
      settings.coc.radius_at_infinity_px * (depth_m - settings.coc.focus_m) / depth_m;
  const Floats magnitude = smaller(absolute(radius), splat(settings.max_coc_px));
  return select(radius < 0.0f, -magnitude, magnitude);
}

struct TwoVectors {
  Floats first, second;
};
template <std::size_t... lane>
SOFTFOCUS_INLINE TwoVectors unzip_lanes(Floats a, Floats b, std::index_sequence<lane...>) {
  return {__builtin_shufflevector(a, b, (2 * lane)...),
          __builtin_shufflevector(a, b, (2 * lane + 1)...)};
}
template <std::size_t... lane>
SOFTFOCUS_INLINE TwoVectors zip_lanes(Floats a, Floats b, std::index_sequence<lane...>) {
  return {__builtin_shufflevector(a, b, (lane / 2 + lane % 2 * kLanes)...),
          __builtin_shufflevector(a, b, (kLanes / 2 + lane / 2 + lane % 2 * kLanes)...)};
}
/// The numbers at even and at odd places of two vectors side by side.
SOFTFOCUS_INLINE TwoVectors unzip(Floats a, Floats b) {
  return unzip_lanes(a, b, std::make_index_sequence<kLanes>{});
}
SOFTFOCUS_INLINE TwoVectors load_pairs(const float* from) {
  return unzip(load(from), load(from + kLanes));
}
/// Two vectors side by side with numbers of `a` and `b` by turns.
SOFTFOCUS_INLINE TwoVectors zip(Floats a, Floats b) {
  return zip_lanes(a, b, std::make_index_sequence<kLanes>{});
}

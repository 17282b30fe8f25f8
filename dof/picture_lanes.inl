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

// Pixels and the formulas of weights.h in lanes, in its order of operations. For kernels
// (raster/lanes/for_each_isa.inl).

/// Pixels x to x + kLanes - 1 of a row. Past its ends the row repeats its outermost pixels.
SOFTFOCUS_INLINE HalfTexels load_repeating(const std::uint16_t* row, int x, int width) {
  if (x >= 0 && x + kLanes <= width) return load_half_texels(row + 4 * x);
  std::uint16_t texels[4 * kLanes];
  for (int i = 0; i < kLanes; ++i) {
    const int inside = x + i < 0 ? 0 : x + i < width ? x + i : width - 1;
    std::memcpy(texels + 4 * i, row + 4 * inside, 4 * sizeof *texels);
  }
  return load_half_texels(texels);
}

/// Stores pixels x to x + kLanes - 1 of a row, as far as the row has them.
SOFTFOCUS_INLINE void store_within(std::uint16_t* row, int x, int width, const HalfTexels& texels) {
  if (x + kLanes <= width) return store_half_texels(row + 4 * x, texels);
  std::uint16_t last[4 * kLanes];
  store_half_texels(last, texels);
  std::memcpy(row + 4 * x, last, 4 * sizeof *last * static_cast<std::size_t>(width - x));
}

SOFTFOCUS_INLINE Floats filter_radius(const DofSettings& settings, Floats depth_m) {
  const Floats radius =
      absolute(settings.coc.radius_at_infinity_px * (depth_m - settings.coc.focus_m) / depth_m);
  return smaller(radius, splat(settings.max_coc_px));
}

SOFTFOCUS_INLINE Floats intensity(Floats radius_px) {
  const Floats radius = larger(radius_px, splat(1.0f));
  return 1.0f / (radius * radius);
}

SOFTFOCUS_INLINE Floats overlap(Floats radius_px, Floats distance_px) {
  return larger(smaller(radius_px - distance_px, splat(1.0f)), splat(0.0f));
}

SOFTFOCUS_INLINE Floats leakage(Floats receiver_radius_px, float leak) {
  return smaller(leak * receiver_radius_px, splat(1.0f));
}

SOFTFOCUS_INLINE Floats clamp_to_half(Floats value) {
  return larger(splat(-65504.0f), smaller(splat(65504.0f), value));
}

/// A pixel's radius; the sign bit is set if it lies beyond the focus.
SOFTFOCUS_INLINE Floats signed_radius(const DofSettings& settings, Floats depth_m) {
  const Mask beyond = depth_m > settings.coc.focus_m;
  return as_floats(as_bits(filter_radius(settings, depth_m)) | (as_bits(beyond) & 0x80000000u));
}

/// The half that store_texel writes for a depth that load_texel read: there is one NaN.
SOFTFOCUS_INLINE Bits stored_depth(Bits half, HalfRounding rounding) {
  const std::uint32_t largest = largest_kept_half(rounding);
  return select((half & 0x7FFFu) > largest, splat(std::uint32_t{kHalfNan}), half);
}

/// The two sums of a gather.
struct Sums {
  Floats weight, r, g, b;
};

/// The receiver's own share (13): intensity, and intensity * colour, in vectors `stride` apart.
SOFTFOCUS_INLINE Sums load_sums(const float* whole, std::ptrdiff_t stride) {
  return {load(whole), load(whole + stride), load(whole + 2 * stride), load(whole + 3 * stride)};
}

/// Adds neighbours of overlap 1 and leakage 1, in the form that load_sums() reads.
SOFTFOCUS_INLINE void add_whole(Sums& sums, const float* whole, std::ptrdiff_t stride) {
  sums.weight = sums.weight + load(whole);
  sums.r = sums.r + load(whole + stride);
  sums.g = sums.g + load(whole + 2 * stride);
  sums.b = sums.b + load(whole + 3 * stride);
}

/// Adds neighbours of any weight (14). Colour sums change only where the weight is positive:
/// 0 * colour may be NaN or -0. The sum of weights is positive, so adding 0 changes nothing.
template <bool leaking>
SOFTFOCUS_INLINE void add_part(Sums& sums, Floats signed_radius_px, Floats light,
                               const float* colour, std::ptrdiff_t stride, Floats distance_px,
                               Floats receiver_leakage) {
  Floats weight = overlap(absolute(signed_radius_px), distance_px) * light;
  if constexpr (leaking) {
    weight = select(as_ints(signed_radius_px) < 0, weight * receiver_leakage, weight);
  }
  const Mask counts = weight > 0.0f;
  sums.weight = sums.weight + weight;
  sums.r = select(counts, sums.r + load(colour) * weight, sums.r);
  sums.g = select(counts, sums.g + load(colour + stride) * weight, sums.g);
  sums.b = select(counts, sums.b + load(colour + 2 * stride) * weight, sums.b);
}

/// The colour of a receiver as the halves that are stored.
struct HalfColour {
  Bits r, g, b;
};
struct FloatColour {
  Floats r, g, b;
};
SOFTFOCUS_INLINE FloatColour resolve(const Sums& sums) {
  return {clamp_to_half(sums.r / sums.weight), clamp_to_half(sums.g / sums.weight),
          clamp_to_half(sums.b / sums.weight)};
}
template <HalfRounding rounding>
SOFTFOCUS_INLINE HalfColour resolve(const Sums& sums) {
  const FloatColour colour = resolve(sums);
  return {float_to_half<rounding>(colour.r), float_to_half<rounding>(colour.g),
          float_to_half<rounding>(colour.b)};
}

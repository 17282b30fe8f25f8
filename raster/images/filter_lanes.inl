// Texels of vectors of pixels, filtered. sample_lanes.cpp includes this, after
// raster/images/sample_lanes.inl.

namespace {

SOFTFOCUS_INLINE constexpr bool is_llvmpipe(LaneArithmetic arithmetic) {
  return arithmetic == LaneArithmetic::llvmpipe_fused ||
         arithmetic == LaneArithmetic::llvmpipe_unfused ||
         arithmetic == LaneArithmetic::llvmpipe_integers;
}

SOFTFOCUS_INLINE constexpr bool has_fixed_weights(LaneArithmetic arithmetic) {
  return arithmetic == LaneArithmetic::standard_fixed_8 ||
         arithmetic == LaneArithmetic::standard_integers;
}

/// Whether the scalar form flushes subnormals between its steps.
SOFTFOCUS_INLINE constexpr bool flushes_floats(LaneArithmetic arithmetic) {
  return arithmetic == LaneArithmetic::llvmpipe_fused ||
         arithmetic == LaneArithmetic::llvmpipe_unfused ||
         arithmetic == LaneArithmetic::swiftshader ||
         arithmetic == LaneArithmetic::standard_flushed;
}

// --- texels, four floats each, of kLanes / 4 pixels ---
//
// Group `group` of a vector's lanes, 0 to 3, has lanes group, group + 4, group + 8 and
// group + 12: what spreads a lane over its texel, and transposes four groups, stays within
// 128 bits.

/// The channels of four groups, lane by lane.
SOFTFOCUS_INLINE RgbaLanes transpose_groups(Floats group0, Floats group1, Floats group2,
                                            Floats group3) {
  transpose_fours(group0, group1, group2, group3);
  return {group0, group1, group2, group3};
}

/// Texels of a group, where `offsets` begins with its first lane's.
SOFTFOCUS_INLINE Floats load_texels(const float* texels, const std::int32_t* offsets) {
#if SOFTFOCUS_LANES == 16
  const __m512 first = _mm512_castps128_ps512(_mm_load_ps(texels + offsets[0]));
  const __m512 second = _mm512_insertf32x4(first, _mm_load_ps(texels + offsets[4]), 1);
  const __m512 third = _mm512_insertf32x4(second, _mm_load_ps(texels + offsets[8]), 2);
  return (Floats)_mm512_insertf32x4(third, _mm_load_ps(texels + offsets[12]), 3);
#elif SOFTFOCUS_LANES == 8
  const __m256 first = _mm256_castps128_ps256(_mm_load_ps(texels + offsets[0]));
  return (Floats)_mm256_insertf128_ps(first, _mm_load_ps(texels + offsets[4]), 1);
#else
  return load(texels + offsets[0]);
#endif
}

/// The scalar samplers' lerp.
///
/// llvmpipe's and SwiftShader's flush subnormals; here it need not, as none occur:
/// - Texels of 8 and 16 bits are multiples of 2^-35 (the cubic's least value is 2^-11.7, with 24
///   bits).
/// - Positions are multiples of 2^-25, as half a texel was subtracted: from 1/4 on the minuend is
///   such a multiple, and below 1/4 the difference is at least 1/4. So are weights along an axis.
/// - Differences, products and sums of multiples are multiples, rounded or not: of 2^-60 after a
///   row, of 2^-85 after both.
/// - The next level's weight is 0, or at least 2^-16 and a multiple of 2^-39; sample() does the
///   lower ones. So results are multiples of 2^-124: 0 or normal numbers.
/// Volumes have a third weight, and thirds of texels lie at the corners of cubes: a level's values
/// are multiples of 2^-110, their products with a level's weight 0 or normal numbers, and only the
/// last sum is flushed (flush_sums()).
template <LaneArithmetic arithmetic>
SOFTFOCUS_INLINE Floats mix(Floats a, Floats b, Floats t) {
  if constexpr (arithmetic == LaneArithmetic::llvmpipe_fused) {
    return fused_multiply_add(t, b - a, a);
  } else if constexpr (arithmetic == LaneArithmetic::llvmpipe_integers) {
    // lerp_unorm8(): whole numbers up to 255, and multiples of 1/256, all exact.
    return a + floor(t * (b - a) + 0.5f);
  } else {
    return t * (b - a) + a;
  }
}

/// Between a colour of a level and one of the next.
///
/// In integers, filter_in_integers()'s sum, rounded once. A level's colours are exact multiples of
/// 2^-16 below 2^8, as are the products and sums that lead to them: 24 bits. The third weight adds
/// 8 bits. So wholes and fractions are mixed apart, as exact multiples of 2^-8 below 2^8 and of
/// 2^-24 below 1. Only their sum is rounded.
template <LaneArithmetic arithmetic>
SOFTFOCUS_INLINE Floats mix_levels(Floats fine, Floats coarse, Floats weight) {
  if constexpr (arithmetic == LaneArithmetic::standard_integers) {
    const Floats fine_whole = to_floats(truncate(fine)), coarse_whole = to_floats(truncate(coarse));
    return mix<arithmetic>(fine_whole, coarse_whole, weight) +
           mix<arithmetic>(fine - fine_whole, coarse - coarse_whole, weight);
  } else {
    return mix<arithmetic>(fine, coarse, weight);
  }
}

/// A bilinear fetch a lane: its texels' offsets, first row before second, and weights.
struct FetchLanes {
  /// Of squares the first texel's alone.
  alignas(64) std::int32_t offsets[4][kLanes];
  Floats weight_u, weight_v;
  Floats weight_w;  ///< of the slice behind, in a volume
  bool neighbours;  ///< whether every lane's second texel of a row lies beside the first
  /// Floats from row to row if also the second row lies below the first, in one level: then every
  /// lane reads a square. Else 0.
  std::int32_t square_row;
};

/// How the four texels of a fetch lie.
enum class Footprint : std::uint8_t { apart, pairs, squares };

/// Adds the offsets that squares do without.
[[gnu::noinline]] inline void complete_offsets(FetchLanes& fetch) {
  if (fetch.square_row == 0) return;
  const Ints first = load(fetch.offsets[0]);
  store(fetch.offsets[1], first + 4);
  store(fetch.offsets[2], first + fetch.square_row);
  store(fetch.offsets[3], first + fetch.square_row + 4);
  keep_in_memory(fetch.offsets);
  fetch.square_row = 0;
}

/// Both texels of a row, for a group. Neighbours come in one load: a third faster on AVX-512,
/// and it saves offsets on all units.
template <Footprint footprint>
SOFTFOCUS_INLINE void load_row(const float* texels, const std::int32_t* first_offsets,
                               const std::int32_t* second_offsets, Floats& first, Floats& second) {
  if constexpr (footprint == Footprint::apart) {
    first = load_texels(texels, first_offsets);
    second = load_texels(texels, second_offsets);
    return;
  }
#if SOFTFOCUS_LANES == 16
  const __m512 low = _mm512_maskz_insertf32x8(
      0xFFFF, _mm512_castps256_ps512(_mm256_loadu_ps(texels + first_offsets[0])),
      _mm256_loadu_ps(texels + first_offsets[4]), 1);
  const __m512 high = _mm512_maskz_insertf32x8(
      0xFFFF, _mm512_castps256_ps512(_mm256_loadu_ps(texels + first_offsets[8])),
      _mm256_loadu_ps(texels + first_offsets[12]), 1);
  first = (Floats)_mm512_maskz_shuffle_f32x4(0xFFFF, low, high, 0b10'00'10'00);
  second = (Floats)_mm512_maskz_shuffle_f32x4(0xFFFF, low, high, 0b11'01'11'01);
#elif SOFTFOCUS_LANES == 8
  const __m256 low = _mm256_loadu_ps(texels + first_offsets[0]);
  const __m256 high = _mm256_loadu_ps(texels + first_offsets[4]);
  first = (Floats)_mm256_permute2f128_ps(low, high, 0x20);
  second = (Floats)_mm256_permute2f128_ps(low, high, 0x31);
#else
  first = load(texels + first_offsets[0]);
  second = load(texels + first_offsets[0] + 4);
#endif
}

template <LaneArithmetic arithmetic, Footprint footprint, int group>
SOFTFOCUS_INLINE Floats filter_level(const float* texels, const FetchLanes& fetch) {
  // One offset a lane serves both rows of a square.
  constexpr bool kSquare = footprint == Footprint::squares;
  const float* second_row = kSquare ? texels + fetch.square_row : texels;
  constexpr std::size_t kSecondRow = kSquare ? 0 : 2;
  const Floats weight_u = spread<group>(fetch.weight_u);
  Floats first, second;
  load_row<footprint>(texels, fetch.offsets[0] + group, fetch.offsets[1] + group, first, second);
  const Floats upper = mix<arithmetic>(first, second, weight_u);
  load_row<footprint>(second_row, fetch.offsets[kSecondRow] + group,
                      fetch.offsets[kSecondRow + 1] + group, first, second);
  const Floats lower = mix<arithmetic>(first, second, weight_u);
  return mix<arithmetic>(upper, lower, spread<group>(fetch.weight_v));
}

/// `coarse` is the next level's, read if there are `two_levels`.
template <LaneArithmetic arithmetic, Footprint footprint, bool two_levels, int group>
SOFTFOCUS_INLINE Floats filter_group(const float* texels, const FetchLanes& fine,
                                     const FetchLanes& coarse, Floats next_weight) {
  const Floats colour = filter_level<arithmetic, footprint, group>(texels, fine);
  if constexpr (!two_levels) return colour;
  const Floats next = filter_level<arithmetic, footprint, group>(texels, coarse);
  const Floats weight = spread<group>(next_weight);
  if constexpr (arithmetic == LaneArithmetic::swiftshader)
    return mix_levels<arithmetic>(colour, next, weight);
  // With a weight of 0 the sum would change infinities, NaN and -0.
  return select(weight > 0.0f, mix_levels<arithmetic>(colour, next, weight), colour);
}

/// Not inlined: with all forms in one function g++ computes all their addresses first and runs out
/// of registers. That takes half as long again.
template <LaneArithmetic arithmetic, Footprint footprint, bool two_levels>
[[gnu::noinline]] void filter_lanes(const float* texels, const FetchLanes& fine,
                                    const FetchLanes& coarse, const Floats& next_weight,
                                    RgbaLanes& colour) {
  colour = transpose_groups(
      filter_group<arithmetic, footprint, two_levels, 0>(texels, fine, coarse, next_weight),
      filter_group<arithmetic, footprint, two_levels, 1>(texels, fine, coarse, next_weight),
      filter_group<arithmetic, footprint, two_levels, 2>(texels, fine, coarse, next_weight),
      filter_group<arithmetic, footprint, two_levels, 3>(texels, fine, coarse, next_weight));
}

}  // namespace

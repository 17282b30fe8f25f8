// sample() and level_of_detail() for kLanes pixels at once, to the bit. A kernel file, to
// be included by those that sample; raster/images/decoded_texture.h comes before.
//
// Addresses and weights are computed a lane each. Texels are four floats, so that one load
// brings a texel: they are filtered kLanes / 4 pixels a vector, and transposed at the end.
// Gathering red, green and blue by themselves would take three times as many loads.

struct RgbLanes {
  Floats r, g, b;
};

/// level_of_detail() of the plain unit and llvmpipe.
SOFTFOCUS_INLINE Floats level_of_detail_lanes(const DecodedTexture& texture, Floats du_dx,
                                              Floats dv_dx, Floats du_dy, Floats dv_dy) {
  const float width = static_cast<float>(texture.source->levels.front().width);
  const float height = static_cast<float>(texture.source->levels.front().height);
  const Floats s_x = du_dx * width;
  const Floats t_x = dv_dx * height;
  const Floats s_y = du_dy * width;
  const Floats t_y = dv_dy * height;
  const Bits bits = as_bits(larger(s_x * s_x + t_x * t_x, s_y * s_y + t_y * t_y));
  const Floats mantissa = as_floats((bits & 0x007FFFFFu) | 0x3F800000u);
  return 0.5f * (to_floats(as_ints(bits >> 23 & 0xFFu) - 128) + mantissa);
}

#include "raster/images/taps_lanes.inl"

// --- texels, four floats each, of kLanes / 4 pixels ---
//
// Group `group` of a vector's lanes, 0 to 3, has lanes group, group + 4, group + 8 and
// group + 12: what spreads a lane over its texel, and transposes four groups, stays within
// 128 bits.

template <int group, std::size_t... lane>
SOFTFOCUS_INLINE Floats spread_over(Floats v, std::index_sequence<lane...>) {
  return __builtin_shufflevector(v, v, ((lane & ~std::size_t{3}) + group)...);
}
template <int group>
SOFTFOCUS_INLINE Floats spread(Floats v) {
  return spread_over<group>(v, std::make_index_sequence<kLanes>{});
}

// Of each four lanes: the first, second, third and fourth of two vectors by turns.
template <std::size_t from, std::size_t... lane>
SOFTFOCUS_INLINE Floats interleave_lanes(Floats a, Floats b, std::index_sequence<lane...>) {
  return __builtin_shufflevector(
      a, b, ((lane & ~std::size_t{3}) + from + (lane & 3) / 2 + (lane & 1) * kLanes)...);
}
template <std::size_t from>
SOFTFOCUS_INLINE Floats interleave(Floats a, Floats b) {
  return interleave_lanes<from>(a, b, std::make_index_sequence<kLanes>{});
}

// Of each four lanes two of `a`, then two of `b`.
template <std::size_t from, std::size_t... lane>
SOFTFOCUS_INLINE Floats join_lanes(Floats a, Floats b, std::index_sequence<lane...>) {
  return __builtin_shufflevector(
      a, b, ((lane & ~std::size_t{3}) + from + (lane & 1) + (lane & 2) / 2 * kLanes)...);
}
template <std::size_t from>
SOFTFOCUS_INLINE Floats join(Floats a, Floats b) {
  return join_lanes<from>(a, b, std::make_index_sequence<kLanes>{});
}

/// The channels of four groups, lane by lane.
SOFTFOCUS_INLINE RgbLanes transpose_groups(Floats group0, Floats group1, Floats group2,
                                           Floats group3) {
  const Floats rg01 = interleave<0>(group0, group1);
  const Floats rg23 = interleave<0>(group2, group3);
  const Floats ba01 = interleave<2>(group0, group1);
  const Floats ba23 = interleave<2>(group2, group3);
  return {join<0>(rg01, rg23), join<2>(rg01, rg23), join<0>(ba01, ba23)};
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
/// llvmpipe's flushes subnormals, of which there are none, so that nothing need be flushed:
/// texels of 8 and 16 bits are multiples of 2^-35 (the cubic's least value is 2^-11.7, with
/// 24 bits). Positions are multiples of 2^-25, for half a texel was subtracted: what they
/// came from is one from 1/4 on, and below that the difference is 1/4 at least; so are
/// weights along an axis. Differences, products and sums of multiples are multiples, and
/// stay so when rounded: of 2^-60 after a row, of 2^-85 after both. The weight of the next
/// level is 0 or from 2^-16 on a multiple of 2^-39 (lower ones go to sample()), and all
/// that comes of it a multiple of 2^-124: 0 or a normal number.
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

/// A bilinear fetch a lane: where its texels lie, first row's before second's, and weights.
struct FetchLanes {
  alignas(64) std::int32_t offsets[4][kLanes];
  Floats weight_u, weight_v;
  bool neighbours;  ///< whether every lane's second texel of a row lies beside the first
};

/// Both texels of a row, of a group. `neighbours` come in one load, which is a third faster
/// on AVX-512 and saves offsets on all.
template <bool neighbours>
SOFTFOCUS_INLINE void load_row(const float* texels, const std::int32_t* first_offsets,
                               const std::int32_t* second_offsets, Floats& first, Floats& second) {
  if constexpr (!neighbours) {
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

template <LaneArithmetic arithmetic, bool neighbours, int group>
SOFTFOCUS_INLINE Floats filter_level(const float* texels, const FetchLanes& fetch) {
  const Floats weight_u = spread<group>(fetch.weight_u);
  Floats first, second;
  load_row<neighbours>(texels, fetch.offsets[0] + group, fetch.offsets[1] + group, first, second);
  const Floats upper = mix<arithmetic>(first, second, weight_u);
  load_row<neighbours>(texels, fetch.offsets[2] + group, fetch.offsets[3] + group, first, second);
  const Floats lower = mix<arithmetic>(first, second, weight_u);
  return mix<arithmetic>(upper, lower, spread<group>(fetch.weight_v));
}

/// `coarse` is the next level's and null where no lane needs it.
template <LaneArithmetic arithmetic, bool neighbours, int group>
SOFTFOCUS_INLINE Floats filter_group(const float* texels, const FetchLanes& fine,
                                     const FetchLanes* coarse, Floats next_weight) {
  const Floats colour = filter_level<arithmetic, neighbours, group>(texels, fine);
  if (coarse == nullptr) return colour;
  const Floats next = filter_level<arithmetic, neighbours, group>(texels, *coarse);
  const Floats weight = spread<group>(next_weight);
  // A weight of 0 leaves alone what the sum would not: infinities, NaN, -0.
  return select(weight > 0.0f, mix<arithmetic>(colour, next, weight), colour);
}

template <LaneArithmetic arithmetic, bool neighbours>
SOFTFOCUS_INLINE RgbLanes filter_lanes(const float* texels, const FetchLanes& fine,
                                       const FetchLanes* coarse, Floats next_weight) {
  return transpose_groups(
      filter_group<arithmetic, neighbours, 0>(texels, fine, coarse, next_weight),
      filter_group<arithmetic, neighbours, 1>(texels, fine, coarse, next_weight),
      filter_group<arithmetic, neighbours, 2>(texels, fine, coarse, next_weight),
      filter_group<arithmetic, neighbours, 3>(texels, fine, coarse, next_weight));
}

// --- a texture ---

SOFTFOCUS_INLINE constexpr bool is_llvmpipe(LaneArithmetic arithmetic) {
  return arithmetic == LaneArithmetic::llvmpipe_fused ||
         arithmetic == LaneArithmetic::llvmpipe_unfused ||
         arithmetic == LaneArithmetic::llvmpipe_integers;
}

// What does not change from level to level.
struct PlaceLanes {
  const DecodedTexture& texture;
  const Sampler& sampler;
  Floats u, v;
};

SOFTFOCUS_INLINE AxisLanes axis_u(const PlaceLanes& place, Ints level) {
  const DecodedAxis& levels = place.texture.u;
  return {levels, place.sampler.wrap_u, place.u, level, look_up(levels.sizes, level)};
}

SOFTFOCUS_INLINE AxisLanes axis_v(const PlaceLanes& place, Ints level) {
  const DecodedAxis& levels = place.texture.v;
  return {levels, place.sampler.wrap_v, place.v, level, look_up(levels.sizes, level)};
}

template <LaneArithmetic arithmetic>
SOFTFOCUS_INLINE TapLanes taps(const AxisLanes& axis) {
  if constexpr (arithmetic == LaneArithmetic::llvmpipe_integers) {
    return unorm8_taps(axis);
  } else if constexpr (is_llvmpipe(arithmetic)) {
    return llvmpipe_taps(axis);
  } else {
    return plain_taps(axis, arithmetic == LaneArithmetic::plain_fixed_8);
  }
}

// A level's row of texels y, as an offset in floats. Below 2^31, as DecodedTexture's are.
SOFTFOCUS_INLINE Ints row_offset(const DecodedTexture& texture, Ints level, Floats width, Ints y) {
  return look_up(texture.starts, level) + y * (truncate(width) << 2);
}

template <LaneArithmetic arithmetic>
SOFTFOCUS_INLINE void find_fetch(const PlaceLanes& place, Ints level, FetchLanes& fetch) {
  const AxisLanes along_u = axis_u(place, level);
  const TapLanes u = taps<arithmetic>(along_u);
  const TapLanes v = taps<arithmetic>(axis_v(place, level));
  const Ints upper = row_offset(place.texture, level, along_u.size, v.first);
  const Ints lower = row_offset(place.texture, level, along_u.size, v.second);
  store(fetch.offsets[0], upper + (u.first << 2));
  store(fetch.offsets[1], upper + (u.second << 2));
  store(fetch.offsets[2], lower + (u.first << 2));
  store(fetch.offsets[3], lower + (u.second << 2));
  keep_in_memory(fetch.offsets);
  fetch.weight_u = u.weight;
  fetch.weight_v = v.weight;
  fetch.neighbours = all(u.second == u.first + 1);
}

template <LaneArithmetic arithmetic>
SOFTFOCUS_INLINE RgbLanes sample_nearest(const PlaceLanes& place, Ints level) {
  constexpr bool kLlvmpipe = is_llvmpipe(arithmetic);
  const AxisLanes along_u = axis_u(place, level);
  const AxisLanes along_v = axis_v(place, level);
  const Ints x = kLlvmpipe ? llvmpipe_nearest(along_u) : plain_nearest(along_u);
  const Ints y = kLlvmpipe ? llvmpipe_nearest(along_v) : plain_nearest(along_v);
  alignas(64) std::int32_t offsets[kLanes];
  store(offsets, row_offset(place.texture, level, along_u.size, y) + (x << 2));
  const float* texels = place.texture.texels.data();
  return transpose_groups(load_texels(texels, offsets), load_texels(texels, offsets + 1),
                          load_texels(texels, offsets + 2), load_texels(texels, offsets + 3));
}

template <LaneArithmetic arithmetic>
SOFTFOCUS_INLINE RgbLanes sample_linear(const PlaceLanes& place, const LevelLanes& levels,
                                        bool two_levels) {
  const float* texels = place.texture.texels.data();
  const Floats weight = levels.next_weight;
  FetchLanes fine;
  find_fetch<arithmetic>(place, levels.first, fine);
  if (!two_levels) {
    return fine.neighbours ? filter_lanes<arithmetic, true>(texels, fine, nullptr, weight)
                           : filter_lanes<arithmetic, false>(texels, fine, nullptr, weight);
  }
  FetchLanes coarse;
  const Ints next = smaller(levels.first + 1, splat(place.texture.level_count - 1));
  find_fetch<arithmetic>(place, next, coarse);
  return fine.neighbours && coarse.neighbours
             ? filter_lanes<arithmetic, true>(texels, fine, &coarse, weight)
             : filter_lanes<arithmetic, false>(texels, fine, &coarse, weight);
}

/// sample() itself, lane by lane.
[[gnu::noinline]] inline void sample_by_lane(const DecodedTexture& texture, const Sampler& sampler,
                                             const Floats& u, const Floats& v, const Floats& lod,
                                             const Mask& active, const Profile& profile,
                                             RgbLanes& colour) {
  colour = RgbLanes{Floats{}, Floats{}, Floats{}};
  for (unsigned lanes = lane_bits(active); lanes != 0; lanes &= lanes - 1) {
    const int i = __builtin_ctz(lanes);
    const glm::vec4 value = sample(*texture.source, sampler, {u[i], v[i]}, lod[i], profile);
    colour.r[i] = value.x;
    colour.g[i] = value.y;
    colour.b[i] = value.z;
  }
}

/// sample() of the lanes that are `active`, in the arithmetic that lane_arithmetic() chose;
/// the others may hold anything, and get anything. One copy for all who sample, for it is
/// long.
template <LaneArithmetic arithmetic>
[[gnu::noinline]] void sample_lanes(const DecodedTexture& texture, const Sampler& sampler,
                                    const Floats& u, const Floats& v, const Floats& lod,
                                    const Mask& active, const Profile& profile, RgbLanes& colour) {
  if constexpr (arithmetic == LaneArithmetic::by_sample) {
    sample_by_lane(texture, sampler, u, v, lod, active, profile, colour);
    return;
  }
  const int last = texture.level_count - 1;
  const bool trilinear = sampler.filter == Filter::trilinear;
  PlaceLanes place{texture, sampler, u, v};
  LevelLanes levels;
  if constexpr (is_llvmpipe(arithmetic)) {
    const Mask flushed_u = absolute(u) < 0x1p-126f;
    const Mask flushed_v = absolute(v) < 0x1p-126f;
    place.u = select(flushed_u, splat(0.0f), u);
    place.v = select(flushed_v, splat(0.0f), v);
    levels = choose_llvmpipe_levels(lod, last, trilinear);
    if constexpr (arithmetic == LaneArithmetic::llvmpipe_integers) {
      levels.next_weight = floor(levels.next_weight * 256.0f) * (1.0f / 256.0f);
    }
  } else {
    place.u = select(absolute(u) < __builtin_inff(), u, splat(0.0f));
    place.v = select(absolute(v) < __builtin_inff(), v, splat(0.0f));
    levels = choose_plain_levels(lod, last, trilinear, arithmetic == LaneArithmetic::plain_fixed_8);
  }
  if (sampler.filter == Filter::nearest) {
    colour = sample_nearest<arithmetic>(place, levels.first);
  } else {
    const Mask mixed = (levels.next_weight > 0.0f) & active;
    const bool two_levels = any(mixed);
    if constexpr (arithmetic == LaneArithmetic::llvmpipe_fused ||
                  arithmetic == LaneArithmetic::llvmpipe_unfused) {
      if (two_levels && any((levels.next_weight < 0x1p-16f) & mixed)) {
        sample_by_lane(texture, sampler, u, v, lod, active, profile, colour);
        return;
      }
    }
    colour = sample_linear<arithmetic>(place, levels, two_levels);
  }
  if constexpr (is_llvmpipe(arithmetic)) {
    colour.r *= texture.scale;
    colour.g *= texture.scale;
    colour.b *= texture.scale;
  }
}

/// The same, choosing at each call.
SOFTFOCUS_INLINE RgbLanes sample_lanes(const DecodedTexture& texture, const Sampler& sampler,
                                       Floats u, Floats v, Floats lod, Mask active,
                                       const Profile& profile) {
  using enum LaneArithmetic;
  RgbLanes colour;
  switch (lane_arithmetic(texture, sampler, profile)) {
    case by_sample:
      sample_lanes<by_sample>(texture, sampler, u, v, lod, active, profile, colour);
      break;
    case plain: sample_lanes<plain>(texture, sampler, u, v, lod, active, profile, colour); break;
    case plain_fixed_8:
      sample_lanes<plain_fixed_8>(texture, sampler, u, v, lod, active, profile, colour);
      break;
    case llvmpipe_fused:
      sample_lanes<llvmpipe_fused>(texture, sampler, u, v, lod, active, profile, colour);
      break;
    case llvmpipe_unfused:
      sample_lanes<llvmpipe_unfused>(texture, sampler, u, v, lod, active, profile, colour);
      break;
    case llvmpipe_integers:
      sample_lanes<llvmpipe_integers>(texture, sampler, u, v, lod, active, profile, colour);
      break;
  }
  return colour;
}

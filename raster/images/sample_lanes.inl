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

// --- which levels ---

/// table[index]. Needs 0 <= index < 16.
template <class Number>
SOFTFOCUS_INLINE auto look_up(const std::array<Number, kMaxDecodedLevels>& table, Ints index) {
  using Lanes = decltype(load(table.data()));
#if SOFTFOCUS_LANES == 16
  return (Lanes)_mm512_maskz_permutexvar_epi32(0xFFFF, (__m512i)index, (__m512i)load(table.data()));
#elif SOFTFOCUS_LANES == 8
  const Lanes low = load(table.data());
  const Lanes high = load(table.data() + 8);
  return select(index > 7, (Lanes)_mm256_permutevar8x32_epi32((__m256i)high, (__m256i)index),
                (Lanes)_mm256_permutevar8x32_epi32((__m256i)low, (__m256i)index));
#else
  Lanes values;
  for (int i = 0; i < kLanes; ++i) values[i] = table[static_cast<std::size_t>(index[i])];
  return values;
#endif
}

/// The level that each lane reads, and the weight of the next one.
struct LevelLanes {
  Ints first;
  Floats next_weight;
};

SOFTFOCUS_INLINE LevelLanes choose_plain_levels(Floats lod, int last, bool trilinear,
                                                bool fixed_8) {
  const Floats largest = splat(static_cast<float>(last));
  const Floats level = select(lod > 0.0f, smaller(lod, largest), splat(0.0f));
  if (!trilinear) return {truncate(level + 0.5f), splat(0.0f)};
  const Floats base = floor(level);
  Floats weight = level - base;
  if (fixed_8) weight = nearest(weight * 256.0f) * (1.0f / 256.0f);
  return {truncate(base), weight};
}

// A lod that is no int32 is level 0, one that the profile flushes too.
SOFTFOCUS_INLINE LevelLanes choose_llvmpipe_levels(Floats lod, int last, bool trilinear) {
  const Floats used = select((lod >= 0x1p-126f) & (lod < 0x1p31f), lod, splat(0.0f));
  const Ints end = splat(last);
  if (!trilinear) return {smaller(truncate(nearest(used)), end), splat(0.0f)};
  const Floats base = floor(used);
  const Ints level = truncate(base);
  return {smaller(level, end), select(level < end, used - base, splat(0.0f))};
}

// --- which texels along an axis ---

struct AxisLanes {
  Floats coordinate;
  Floats size;     ///< of the level
  Floats inverse;  ///< its inverse, rounded
  Wrap wrap;
  /// Plain unit: whether all levels' sizes are powers of two. llvmpipe: level 0's.
  bool power_of_two;
};

struct TapLanes {
  Ints first, second;
  Floats weight;
};

// The index modulo `period` that a whole number up to 2^22 + 1 in magnitude has. The
// quotient is off by one at most: its error is below 2^22 times 1.5 * 2^-23. All products
// and differences are whole numbers below 2^24, thus exact.
SOFTFOCUS_INLINE Floats whole_modulo(Floats whole, Floats period, Floats inverse) {
  Floats rest = whole - floor(whole * inverse) * period;
  rest = select(rest < 0.0f, rest + period, rest);
  return select(rest >= period, rest - period, rest);
}

// Two neighbouring texels, the first as a whole number up to 2^22 + 1 in magnitude.
SOFTFOCUS_INLINE void wrap_plain(const AxisLanes& axis, Floats base, Ints& first, Ints& second) {
  const Ints size = truncate(axis.size);
  if (axis.wrap == Wrap::clamp_to_edge) {
    const Ints index = truncate(base);
    first = smaller(larger(index, splat(0)), size - 1);
    second = smaller(larger(index + 1, splat(0)), size - 1);
    return;
  }
  const bool mirrored = axis.wrap == Wrap::mirrored_repeat;
  const Ints last = (mirrored ? size + size : size) - 1;
  if (axis.power_of_two) {
    const Ints index = truncate(base);
    first = index & last;
    second = (index + 1) & last;
  } else {
    const float scale = mirrored ? 2.0f : 1.0f;
    first = truncate(whole_modulo(base, axis.size * scale, axis.inverse * (1.0f / scale)));
    second = select(first == last, splat(0), first + 1);
  }
  if (mirrored) {
    first = smaller(first, last - first);
    second = smaller(second, last - second);
  }
}

// A coordinate scaled to texels. Needs a finite one.
SOFTFOCUS_INLINE Floats plain_texels(const AxisLanes& axis) {
  return smaller(larger(axis.coordinate * axis.size, splat(-0x1p22f)), splat(0x1p22f));
}

SOFTFOCUS_INLINE TapLanes plain_taps(const AxisLanes& axis, bool fixed_8) {
  Floats position = plain_texels(axis) - 0.5f;
  if (fixed_8) position = nearest(position * 256.0f) * (1.0f / 256.0f);
  const Floats base = floor(position);
  TapLanes taps;
  wrap_plain(axis, base, taps.first, taps.second);
  taps.weight = position - base;
  return taps;
}

SOFTFOCUS_INLINE Ints plain_nearest(const AxisLanes& axis) {
  Ints first, second;
  wrap_plain(axis, floor(plain_texels(axis)), first, second);
  return first;
}

// A triangle wave: 0 at even numbers, 1 at odd ones. NaN counts as 0.
SOFTFOCUS_INLINE Floats mirror(Floats coordinate) {
  const Floats half = coordinate * 0.5f;
  const Floats rest = half - nearest(half);
  return larger(absolute(rest + rest), splat(0.0f));
}

SOFTFOCUS_INLINE TapLanes llvmpipe_taps(const AxisLanes& axis) {
  const Ints size = truncate(axis.size);
  if (axis.wrap == Wrap::repeat && axis.power_of_two) {
    const Floats position = axis.coordinate * axis.size - 0.5f;
    const Floats base = floor(position);
    const Bits index = as_bits(truncate_to_int(base));
    const Bits mask = as_bits(size - 1);
    return {as_ints(index & mask), as_ints((index + 1u) & mask), position - base};
  }
  if (axis.wrap == Wrap::repeat) {
    const Floats fraction = axis.coordinate - floor(axis.coordinate);
    const Floats position = fraction * axis.size - 0.5f;
    const Floats base = floor(position);
    const Mask inside = position >= 0.0f;
    const Ints first = select(inside, truncate(select(inside, base, splat(0.0f))), size - 1);
    return {first, select(first == size - 1, splat(0), first + 1), position - base};
  }
  if (axis.wrap == Wrap::clamp_to_edge) {
    const Floats scaled = smaller(axis.coordinate * axis.size, axis.size);
    const Floats position = larger(scaled - 0.5f, splat(0.0f));
    const Floats base = floor(position);
    const Ints first = truncate(base);
    return {first, smaller(first + 1, size - 1), position - base};
  }
  const Floats position = mirror(axis.coordinate) * axis.size - 0.5f;
  const Floats base = floor(position);
  const Ints index = truncate(base);
  return {larger(index, splat(0)), smaller(index + 1, size - 1), position - base};
}

SOFTFOCUS_INLINE Ints llvmpipe_nearest(const AxisLanes& axis) {
  const Ints size = truncate(axis.size);
  const Floats scaled = axis.coordinate * axis.size;
  if (axis.wrap == Wrap::repeat && axis.power_of_two) {
    return truncate_to_int(floor(scaled)) & (size - 1);
  }
  if (axis.wrap == Wrap::repeat) {
    const Floats fraction = axis.coordinate - floor(axis.coordinate);
    return truncate(smaller(fraction, splat(1.0f - 0x1p-24f)) * axis.size);
  }
  if (axis.wrap == Wrap::clamp_to_edge) {
    return smaller(larger(truncate_to_int(scaled), splat(0)), size - 1);
  }
  return smaller(truncate(mirror(axis.coordinate) * axis.size), size - 1);
}

// Taps of unorm8_filter.cpp, which repeat or clamp; weights are multiples of 1/256.
SOFTFOCUS_INLINE TapLanes unorm8_taps(const AxisLanes& axis) {
  const Ints size = truncate(axis.size);
  Floats position_256;
  if (axis.wrap == Wrap::repeat && !axis.power_of_two) {
    position_256 = ((axis.coordinate - floor(axis.coordinate)) * axis.size) * 256.0f;
  } else {
    position_256 = axis.coordinate * (axis.size * 256.0f);
  }
  // What no integer holds wraps round to the far end here.
  const Ints position = as_ints(as_bits(round_to_int(position_256)) - 128u);
  const Floats weight = to_floats(position & 255) * (1.0f / 256.0f);
  const Ints index = position >> 8;
  if (axis.wrap == Wrap::clamp_to_edge) {
    const Ints first = smaller(larger(index, splat(0)), size - 1);
    const Mask inside = (index >= 0) & (index < size - 1);
    return {first, select(inside, index + 1, first), weight};
  }
  if (axis.power_of_two) return {index & (size - 1), (index + 1) & (size - 1), weight};
  const Ints first = select(index < 0, size - 1, smaller(index, size - 1));
  return {first, select(first == size - 1, splat(0), first + 1), weight};
}

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
};

template <LaneArithmetic arithmetic, int group>
SOFTFOCUS_INLINE Floats filter_group(const float* texels, const FetchLanes& fetch) {
  const Floats u = spread<group>(fetch.weight_u);
  const Floats upper = mix<arithmetic>(load_texels(texels, fetch.offsets[0] + group),
                                       load_texels(texels, fetch.offsets[1] + group), u);
  const Floats lower = mix<arithmetic>(load_texels(texels, fetch.offsets[2] + group),
                                       load_texels(texels, fetch.offsets[3] + group), u);
  return mix<arithmetic>(upper, lower, spread<group>(fetch.weight_v));
}

template <LaneArithmetic arithmetic, int group>
SOFTFOCUS_INLINE Floats filter_group(const float* texels, const FetchLanes& fine,
                                     const FetchLanes& coarse, Floats weights) {
  const Floats colour = filter_group<arithmetic, group>(texels, fine);
  const Floats weight = spread<group>(weights);
  // A weight of 0 leaves alone what the sum would not: infinities, NaN, -0.
  return select(weight > 0.0f,
                mix<arithmetic>(colour, filter_group<arithmetic, group>(texels, coarse), weight),
                colour);
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

template <bool llvmpipe>
SOFTFOCUS_INLINE AxisLanes axis_u(const PlaceLanes& place, Ints level) {
  const DecodedTexture& t = place.texture;
  return {place.u, look_up(t.widths, level), look_up(t.inverse_widths, level), place.sampler.wrap_u,
          llvmpipe ? t.base_width_is_power_of_two : t.widths_are_powers_of_two};
}

template <bool llvmpipe>
SOFTFOCUS_INLINE AxisLanes axis_v(const PlaceLanes& place, Ints level) {
  const DecodedTexture& t = place.texture;
  return {place.v, look_up(t.heights, level), look_up(t.inverse_heights, level),
          place.sampler.wrap_v,
          llvmpipe ? t.base_height_is_power_of_two : t.heights_are_powers_of_two};
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
  const Ints start = look_up(texture.starts, level);
  return start + y * (truncate(width) << 2);
}

template <LaneArithmetic arithmetic>
SOFTFOCUS_INLINE void find_fetch(const PlaceLanes& place, Ints level, FetchLanes& fetch) {
  const AxisLanes u_axis = axis_u<is_llvmpipe(arithmetic)>(place, level);
  const TapLanes u = taps<arithmetic>(u_axis);
  const TapLanes v = taps<arithmetic>(axis_v<is_llvmpipe(arithmetic)>(place, level));
  const Ints upper = row_offset(place.texture, level, u_axis.size, v.first);
  const Ints lower = row_offset(place.texture, level, u_axis.size, v.second);
  store(fetch.offsets[0], upper + (u.first << 2));
  store(fetch.offsets[1], upper + (u.second << 2));
  store(fetch.offsets[2], lower + (u.first << 2));
  store(fetch.offsets[3], lower + (u.second << 2));
  fetch.weight_u = u.weight;
  fetch.weight_v = v.weight;
}

template <LaneArithmetic arithmetic>
SOFTFOCUS_INLINE RgbLanes sample_nearest(const PlaceLanes& place, Ints level) {
  constexpr bool kLlvmpipe = is_llvmpipe(arithmetic);
  const AxisLanes u_axis = axis_u<kLlvmpipe>(place, level);
  const AxisLanes v_axis = axis_v<kLlvmpipe>(place, level);
  const Ints x = kLlvmpipe ? llvmpipe_nearest(u_axis) : plain_nearest(u_axis);
  const Ints y = kLlvmpipe ? llvmpipe_nearest(v_axis) : plain_nearest(v_axis);
  alignas(64) std::int32_t offsets[kLanes];
  store(offsets, row_offset(place.texture, level, u_axis.size, y) + (x << 2));
  const float* texels = place.texture.texels.data();
  return transpose_groups(load_texels(texels, offsets), load_texels(texels, offsets + 1),
                          load_texels(texels, offsets + 2), load_texels(texels, offsets + 3));
}

template <LaneArithmetic arithmetic>
SOFTFOCUS_INLINE RgbLanes sample_linear(const PlaceLanes& place, LevelLanes levels,
                                        bool two_levels) {
  const float* texels = place.texture.texels.data();
  FetchLanes fine;
  find_fetch<arithmetic>(place, levels.first, fine);
  if (!two_levels) {
    return transpose_groups(
        filter_group<arithmetic, 0>(texels, fine), filter_group<arithmetic, 1>(texels, fine),
        filter_group<arithmetic, 2>(texels, fine), filter_group<arithmetic, 3>(texels, fine));
  }
  FetchLanes coarse;
  const Ints next = smaller(levels.first + 1, splat(place.texture.level_count - 1));
  find_fetch<arithmetic>(place, next, coarse);
  const Floats weight = levels.next_weight;
  return transpose_groups(filter_group<arithmetic, 0>(texels, fine, coarse, weight),
                          filter_group<arithmetic, 1>(texels, fine, coarse, weight),
                          filter_group<arithmetic, 2>(texels, fine, coarse, weight),
                          filter_group<arithmetic, 3>(texels, fine, coarse, weight));
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
    // Where weights are NaN, what a format lacks still is 0.
    if (channel_count(texture.source->levels.front().format) == 1) {
      colour.g = colour.b = splat(0.0f);
    }
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

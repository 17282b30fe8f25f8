// Sampling in lanes.
//
// Addresses and weights have a lane a pixel. A texel is four floats, which one load brings, so a
// vector filters kLanes / 4 pixels; colours are transposed at the end. Gathering red, green and
// blue would take three loads a texel.

#ifndef SOFTFOCUS_ISA

#include <algorithm>
#include <array>

#include "raster/images/decoded_texture.h"
#include "raster/numbers/half.h"

#define SOFTFOCUS_KERNELS "raster/images/sample_lanes.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {

void sample_vectors(Isa isa, const DecodedTexture& texture, const Sampler& sampler,
                    const Profile& profile, const SamplePoints& points, int count, void* colours) {
  SOFTFOCUS_KERNEL(isa, sample_in_lanes)(texture, sampler, profile, points, count, colours);
}

void decode_halves(Isa isa, const std::uint16_t* from, std::size_t count, float* to) {
  SOFTFOCUS_KERNEL(isa, decode_halves_in_lanes)(from, count, to);
}

}  // namespace softfocus

#else  // once a vector unit

#include "raster/images/sample_lanes.inl"

// The addresses are those of sampler.cpp, integer_filter.cpp and driver_samplers.cpp,
// to the bit. For any coordinate and lod, NaN too, the texels lie in the
// texture.

namespace {

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
  // Neighbouring pixels mostly have one level.
  if (all(index == spread<0>(index))) return splat(table[static_cast<std::size_t>(index[0])]);
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

SOFTFOCUS_INLINE LevelLanes choose_standard_levels(Floats lod, int last, bool trilinear,
                                                   bool fixed_8) {
  const Floats largest = splat(static_cast<float>(last));
  const Floats level = select(lod > 0.0f, smaller(lod, largest), splat(0.0f));
  if (!trilinear) return {truncate(level + 0.5f), splat(0.0f)};
  const Floats base = floor(level);
  Floats weight = level - base;
  if (fixed_8) weight = nearest(weight * 256.0f) * (1.0f / 256.0f);
  return {truncate(base), weight};
}

// Lods that no int32 holds, and those that the profile flushes, give level 0.
SOFTFOCUS_INLINE LevelLanes choose_llvmpipe_levels(Floats lod, int last, bool trilinear) {
  const Floats used = select((lod >= 0x1p-126f) & (lod < 0x1p31f), lod, splat(0.0f));
  const Ints end = splat(last);
  if (!trilinear) return {smaller(truncate(nearest(used)), end), splat(0.0f)};
  const Floats base = floor(used);
  const Ints level = truncate(base);
  return {smaller(level, end), select(level < end, used - base, splat(0.0f))};
}

SOFTFOCUS_INLINE LevelLanes choose_swiftshader_levels(Floats lod, int last, bool trilinear) {
  const Floats used = select(lod >= 0x1p-126f, smaller(lod, splat(1000.0f)), splat(0.0f));
  const Ints end = splat(last);
  if (!trilinear) return {smaller(truncate(nearest(used)), end), splat(0.0f)};
  const Floats base = floor(used);
  return {smaller(truncate(base), end), smaller(used - base, splat(1.0f - 0x1p-24f))};
}

// --- which texels along an axis ---

struct AxisLanes {
  const DecodedAxis& levels;
  Wrap wrap;
  Floats coordinate;
  Ints level;
  Floats size;  ///< of the level
};

struct TapLanes {
  Ints first, second;
  Floats weight;
};

// A whole number, at most 2^22 + 1 in magnitude, modulo `period`. Two roundings move the
// quotient by at most (2^22 + 1) 2^-23 / period. If the number is no multiple, the quotient lies
// at least 1 / period below the next whole number, and its floor is right. A multiple may come
// out short by one. Products and differences are whole numbers below 2^24, thus exact.
SOFTFOCUS_INLINE Floats whole_modulo(Floats whole, Floats period, Floats inverse) {
  const Floats rest = whole - floor(whole * inverse) * period;
  return select(rest >= period, rest - period, rest);
}

// Two neighbouring texels, the first as a whole number up to 2^22 + 1 in magnitude.
SOFTFOCUS_INLINE void wrap_standard(const AxisLanes& axis, Floats base, Ints& first, Ints& second) {
  const Ints size = truncate(axis.size);
  if (axis.wrap == Wrap::clamp_to_edge) {
    const Ints index = truncate(base);
    first = smaller(larger(index, splat(0)), size - 1);
    second = smaller(larger(index + 1, splat(0)), size - 1);
    return;
  }
  const bool mirrored = axis.wrap == Wrap::mirrored_repeat;
  const Ints last = (mirrored ? size + size : size) - 1;
  if (axis.levels.are_powers_of_two) {
    const Ints index = truncate(base);
    first = index & last;
    second = (index + 1) & last;
  } else {
    const float scale = mirrored ? 2.0f : 1.0f;
    const Floats inverse = look_up(axis.levels.inverses, axis.level) * (1.0f / scale);
    first = truncate(whole_modulo(base, axis.size * scale, inverse));
    second = select(first == last, splat(0), first + 1);
  }
  if (mirrored) {
    first = smaller(first, last - first);
    second = smaller(second, last - second);
  }
}

// A coordinate scaled to texels. Needs a finite one.
SOFTFOCUS_INLINE Floats standard_texels(const AxisLanes& axis) {
  return smaller(larger(axis.coordinate * axis.size, splat(-0x1p22f)), splat(0x1p22f));
}

SOFTFOCUS_INLINE TapLanes standard_taps(const AxisLanes& axis, bool fixed_8) {
  Floats position = standard_texels(axis) - 0.5f;
  if (fixed_8) position = nearest(position * 256.0f) * (1.0f / 256.0f);
  const Floats base = floor(position);
  TapLanes taps;
  wrap_standard(axis, base, taps.first, taps.second);
  taps.weight = position - base;
  return taps;
}

SOFTFOCUS_INLINE Ints standard_nearest(const AxisLanes& axis) {
  Ints first, second;
  wrap_standard(axis, floor(standard_texels(axis)), first, second);
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
  if (axis.wrap == Wrap::repeat && axis.levels.base_is_power_of_two) {
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
  if (axis.wrap == Wrap::repeat && axis.levels.base_is_power_of_two) {
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

SOFTFOCUS_INLINE Floats swiftshader_coordinate(const AxisLanes& axis) {
  const Floats u = axis.coordinate;
  const Floats most = splat(1.0f - 0x1p-24f);
  if (axis.wrap == Wrap::clamp_to_edge) return smaller(larger(u, splat(0.0f)), most);
  if (axis.wrap == Wrap::repeat) return smaller(u - floor(u), most);
  return smaller(absolute(u - 2.0f * nearest(u * 0.5f)), most);
}

SOFTFOCUS_INLINE TapLanes swiftshader_taps(const AxisLanes& axis) {
  const Ints last = truncate(axis.size) - 1;
  const Floats position = swiftshader_coordinate(axis) * axis.size - 0.5f;
  const Floats base = floor(position);
  const Ints first = truncate(base);
  const bool repeats = axis.wrap == Wrap::repeat;
  return {select(first < 0, repeats ? last : splat(0), first),
          select(first < last, first + 1, repeats ? splat(0) : last), position - base};
}

SOFTFOCUS_INLINE Ints swiftshader_nearest(const AxisLanes& axis) {
  return truncate(swiftshader_coordinate(axis) * axis.size);
}

SOFTFOCUS_INLINE Ints swiftshader_nearest_byte(const AxisLanes& axis) {
  const Ints size = truncate(axis.size);
  if (axis.wrap == Wrap::clamp_to_edge) {
    const Floats inside = smaller(larger(axis.coordinate, splat(0.0f)), splat(65535.0f / 65536.0f));
    return truncate(inside * 65536.0f) * size >> 16;
  }
  Ints position = truncate_to_int(axis.coordinate * 65536.0f);
  if (axis.wrap == Wrap::mirrored_repeat) {
    position = select((position & 0x10000) != 0, ~position, position);
  }
  return (position & 0xFFFF) * size >> 16;
}

// Taps of integer_filter.cpp, which repeat or clamp; weights are multiples of 1/256.
SOFTFOCUS_INLINE TapLanes unorm8_taps(const AxisLanes& axis) {
  const Ints size = truncate(axis.size);
  Floats position_256;
  if (axis.wrap == Wrap::repeat && !axis.levels.base_is_power_of_two) {
    position_256 = ((axis.coordinate - floor(axis.coordinate)) * axis.size) * 256.0f;
  } else {
    position_256 = axis.coordinate * (axis.size * 256.0f);
  }
  // Positions that no integer holds wrap round to the far end here.
  const Ints position = as_ints(as_bits(round_to_int(position_256)) - 128u);
  const Floats weight = to_floats(position & 255) * (1.0f / 256.0f);
  const Ints index = position >> 8;
  if (axis.wrap == Wrap::clamp_to_edge) {
    const Ints first = smaller(larger(index, splat(0)), size - 1);
    const Mask inside = (index >= 0) & (index < size - 1);
    return {first, select(inside, index + 1, first), weight};
  }
  if (axis.levels.base_is_power_of_two)
    return {index & (size - 1), (index + 1) & (size - 1), weight};
  const Ints first = select(index < 0, size - 1, smaller(index, size - 1));
  return {first, select(first == size - 1, splat(0), first + 1), weight};
}

SOFTFOCUS_INLINE constexpr bool is_llvmpipe(LaneArithmetic arithmetic) {
  return arithmetic == LaneArithmetic::llvmpipe_fused ||
         arithmetic == LaneArithmetic::llvmpipe_unfused ||
         arithmetic == LaneArithmetic::llvmpipe_integers;
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
  alignas(64) std::int32_t offsets[4][kLanes];
  Floats weight_u, weight_v;
  bool neighbours;  ///< whether every lane's second texel of a row lies beside the first
};

/// Both texels of a row, for a group. `neighbours` come in one load: a third faster on AVX-512,
/// and it saves offsets on all units.
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

/// `coarse` is the next level's, read if there are `two_levels`.
template <LaneArithmetic arithmetic, bool neighbours, bool two_levels, int group>
SOFTFOCUS_INLINE Floats filter_group(const float* texels, const FetchLanes& fine,
                                     const FetchLanes& coarse, Floats next_weight) {
  const Floats colour = filter_level<arithmetic, neighbours, group>(texels, fine);
  if constexpr (!two_levels) return colour;
  const Floats next = filter_level<arithmetic, neighbours, group>(texels, coarse);
  const Floats weight = spread<group>(next_weight);
  if constexpr (arithmetic == LaneArithmetic::swiftshader)
    return mix_levels<arithmetic>(colour, next, weight);
  // With a weight of 0 the sum would change infinities, NaN and -0.
  return select(weight > 0.0f, mix_levels<arithmetic>(colour, next, weight), colour);
}

/// Not inlined: with all forms in one function g++ computes all their addresses first and runs out
/// of registers. That takes half as long again.
template <LaneArithmetic arithmetic, bool neighbours, bool two_levels>
[[gnu::noinline]] void filter_lanes(const float* texels, const FetchLanes& fine,
                                    const FetchLanes& coarse, const Floats& next_weight,
                                    RgbaLanes& colour) {
  colour = transpose_groups(
      filter_group<arithmetic, neighbours, two_levels, 0>(texels, fine, coarse, next_weight),
      filter_group<arithmetic, neighbours, two_levels, 1>(texels, fine, coarse, next_weight),
      filter_group<arithmetic, neighbours, two_levels, 2>(texels, fine, coarse, next_weight),
      filter_group<arithmetic, neighbours, two_levels, 3>(texels, fine, coarse, next_weight));
}

// --- a texture ---

// The part of sampling that is common to all levels.
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
  } else if constexpr (arithmetic == LaneArithmetic::swiftshader) {
    return swiftshader_taps(axis);
  } else if constexpr (is_llvmpipe(arithmetic)) {
    return llvmpipe_taps(axis);
  } else {
    return standard_taps(axis, arithmetic != LaneArithmetic::standard);
  }
}

template <LaneArithmetic arithmetic>
SOFTFOCUS_INLINE Ints nearest_texel(const AxisLanes& axis, bool of_bytes) {
  if constexpr (arithmetic == LaneArithmetic::swiftshader) {
    return of_bytes ? swiftshader_nearest_byte(axis) : swiftshader_nearest(axis);
  } else if constexpr (is_llvmpipe(arithmetic)) {
    return llvmpipe_nearest(axis);
  } else {
    return standard_nearest(axis);
  }
}

// The offset, in floats, of row y of a level. Below 2^31, as all of DecodedTexture is.
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
SOFTFOCUS_INLINE RgbaLanes sample_nearest(const PlaceLanes& place, Ints level) {
  const AxisLanes along_u = axis_u(place, level);
  const AxisLanes along_v = axis_v(place, level);
  const Ints x = nearest_texel<arithmetic>(along_u, place.texture.are_whole);
  const Ints y = nearest_texel<arithmetic>(along_v, place.texture.are_whole);
  alignas(64) std::int32_t offsets[kLanes];
  store(offsets, row_offset(place.texture, level, along_u.size, y) + (x << 2));
  const float* texels = place.texture.texels.data();
  return transpose_groups(load_texels(texels, offsets), load_texels(texels, offsets + 1),
                          load_texels(texels, offsets + 2), load_texels(texels, offsets + 3));
}

/// A vector's reads. Found for many vectors before any is filtered.
struct SamplePlan {
  FetchLanes fine, coarse;
  Floats next_weight;
  bool two_levels;
  bool by_lane;  ///< sample() has to do it
};

template <LaneArithmetic arithmetic>
SOFTFOCUS_INLINE LevelLanes choose_levels(Floats lod, int last, bool trilinear) {
  if constexpr (is_llvmpipe(arithmetic)) {
    LevelLanes levels = choose_llvmpipe_levels(lod, last, trilinear);
    if constexpr (arithmetic == LaneArithmetic::llvmpipe_integers) {
      levels.next_weight = floor(levels.next_weight * 256.0f) * (1.0f / 256.0f);
    }
    return levels;
  } else if constexpr (arithmetic == LaneArithmetic::swiftshader) {
    return choose_swiftshader_levels(lod, last, trilinear);
  } else {
    return choose_standard_levels(lod, last, trilinear, arithmetic != LaneArithmetic::standard);
  }
}

template <LaneArithmetic arithmetic>
SOFTFOCUS_INLINE void plan_linear(const PlaceLanes& place, const LevelLanes& levels,
                                  SamplePlan& plan) {
  const Mask mixed = levels.next_weight > 0.0f;
  plan.next_weight = levels.next_weight;
  plan.two_levels = arithmetic == LaneArithmetic::swiftshader
                        ? place.sampler.filter == Filter::trilinear
                        : any(mixed) != 0;
  plan.by_lane = false;
  find_fetch<arithmetic>(place, levels.first, plan.fine);
  // Neighbouring pixels mostly read the same texels: prefetching for every fourth is enough.
  for (int lane = 0; lane < kLanes; lane += 4) {
    __builtin_prefetch(place.texture.texels.data() + plan.fine.offsets[0][lane]);
    __builtin_prefetch(place.texture.texels.data() + plan.fine.offsets[2][lane]);
  }
  if (!plan.two_levels) return;
  if constexpr (arithmetic == LaneArithmetic::llvmpipe_fused ||
                arithmetic == LaneArithmetic::llvmpipe_unfused ||
                arithmetic == LaneArithmetic::swiftshader) {
    plan.by_lane = any((levels.next_weight < 0x1p-16f) & mixed);
  }
  const Ints next = smaller(levels.first + 1, splat(place.texture.level_count - 1));
  find_fetch<arithmetic>(place, next, plan.coarse);
}

template <LaneArithmetic arithmetic>
SOFTFOCUS_INLINE void filter_plan(const float* texels, const SamplePlan& plan, RgbaLanes& colour) {
  const FetchLanes& fine = plan.fine;
  const Floats& weight = plan.next_weight;
  if (!plan.two_levels) {
    if (fine.neighbours) {
      filter_lanes<arithmetic, true, false>(texels, fine, fine, weight, colour);
    } else {
      filter_lanes<arithmetic, false, false>(texels, fine, fine, weight, colour);
    }
  } else if (fine.neighbours && plan.coarse.neighbours) {
    filter_lanes<arithmetic, true, true>(texels, fine, plan.coarse, weight, colour);
  } else {
    filter_lanes<arithmetic, false, true>(texels, fine, plan.coarse, weight, colour);
  }
}

/// sample() itself, lane by lane.
[[gnu::noinline]] inline void sample_by_lane(const DecodedTexture& texture, const Sampler& sampler,
                                             const Profile& profile, SamplePoints points,
                                             int vector, RgbaLanes& colour) {
  for (int lane = 0; lane < kLanes; ++lane) {
    const int i = vector * kLanes + lane;
    const glm::vec4 value =
        sample(*texture.source, sampler, {points.u[i], points.v[i]}, points.lod[i], profile);
    colour.r[lane] = value.x;
    colour.g[lane] = value.y;
    colour.b[lane] = value.z;
    colour.a[lane] = value.w;
  }
}

/// Decodes mixed texels that kept whole numbers, as fetch_texel() decodes texels.
template <LaneArithmetic arithmetic>
SOFTFOCUS_INLINE Floats to_linear(const DecodedTexture& texture, Floats value) {
  if constexpr (arithmetic == LaneArithmetic::standard_integers) {
    return value / 255.0f;
  } else if constexpr (arithmetic == LaneArithmetic::swiftshader) {
    return texture.are_whole ? value * (1.0f / 65280.0f) : value;
  } else if constexpr (is_llvmpipe(arithmetic)) {
    return texture.are_whole ? value * (1.0f / 255.0f) : value;
  } else {
    return value;
  }
}

template <LaneArithmetic arithmetic>
[[gnu::noinline]] void sample_batch(const DecodedTexture& texture, const Sampler& sampler,
                                    const Profile& profile, SamplePoints points, int count,
                                    RgbaLanes* colours) {
  const int last = texture.level_count - 1;
  const bool trilinear = sampler.filter == Filter::trilinear;
  std::array<SamplePlan, kMostSampled> plans;
  for (int i = 0; i < count; ++i) {
    PlaceLanes place{texture, sampler, load(points.u + i * kLanes), load(points.v + i * kLanes)};
    if constexpr (is_llvmpipe(arithmetic) || arithmetic == LaneArithmetic::swiftshader) {
      place.u = select(absolute(place.u) < 0x1p-126f, splat(0.0f), place.u);
      place.v = select(absolute(place.v) < 0x1p-126f, splat(0.0f), place.v);
    } else {
      place.u = select(absolute(place.u) < __builtin_inff(), place.u, splat(0.0f));
      place.v = select(absolute(place.v) < __builtin_inff(), place.v, splat(0.0f));
    }
    const LevelLanes levels =
        choose_levels<arithmetic>(load(points.lod + i * kLanes), last, trilinear);
    if (sampler.filter == Filter::nearest) {
      colours[i] = sample_nearest<arithmetic>(place, levels.first);
    } else {
      plan_linear<arithmetic>(place, levels, plans[static_cast<std::size_t>(i)]);
    }
  }
  for (int i = 0; i < count; ++i) {
    if (sampler.filter != Filter::nearest) {
      const SamplePlan& plan = plans[static_cast<std::size_t>(i)];
      if (plan.by_lane) {
        sample_by_lane(texture, sampler, profile, points, i, colours[i]);
        continue;
      }
      filter_plan<arithmetic>(texture.texels.data(), plan, colours[i]);
    }
    colours[i].r = to_linear<arithmetic>(texture, colours[i].r);
    colours[i].g = to_linear<arithmetic>(texture, colours[i].g);
    colours[i].b = to_linear<arithmetic>(texture, colours[i].b);
    colours[i].a = to_linear<arithmetic>(texture, colours[i].a);
  }
}

}  // namespace

/// sample() of `count` vectors, kMostSampled at most, in the arithmetic that lane_arithmetic()
/// chooses. A vector is a long chain of operations. So addresses of all come first, then all
/// filters: the CPU works on several vectors at once.
void sample_in_lanes(const DecodedTexture& texture, const Sampler& sampler, const Profile& profile,
                     const SamplePoints& points, int count, void* to) {
  auto* colours = static_cast<RgbaLanes*>(to);
  using enum LaneArithmetic;
  switch (lane_arithmetic(texture, sampler, profile)) {
    case by_sample:
      for (int i = 0; i < count; ++i) {
        sample_by_lane(texture, sampler, profile, points, i, colours[i]);
      }
      return;
    case standard: return sample_batch<standard>(texture, sampler, profile, points, count, colours);
    case standard_fixed_8:
      return sample_batch<standard_fixed_8>(texture, sampler, profile, points, count, colours);
    case standard_integers:
      return sample_batch<standard_integers>(texture, sampler, profile, points, count, colours);
    case llvmpipe_fused:
      return sample_batch<llvmpipe_fused>(texture, sampler, profile, points, count, colours);
    case llvmpipe_unfused:
      return sample_batch<llvmpipe_unfused>(texture, sampler, profile, points, count, colours);
    case llvmpipe_integers:
      return sample_batch<llvmpipe_integers>(texture, sampler, profile, points, count, colours);
    case swiftshader:
      return sample_batch<swiftshader>(texture, sampler, profile, points, count, colours);
  }
}

void decode_halves_in_lanes(const std::uint16_t* from, std::size_t count, float* to) {
  std::size_t i = 0;
  for (; i + kLanes <= count; i += kLanes) store(to + i, load_halves(from + i));
  for (; i < count; ++i) to[i] = softfocus::half_to_float(from[i]);
}

#endif

// Vectors of SOFTFOCUS_LANES numbers: one a pixel, a vertex or a triangle. They are the
// compiler's own vector types (g++ and clang): + - * / & | ^ << >> and comparisons work lane by
// lane and round as on single floats. The functions here do in every lane what their scalar
// namesakes do. Only fused_multiply_add() fuses.
//
// Included by for_each_isa.inl, once a vector unit.

inline constexpr int kLanes = SOFTFOCUS_LANES;

using Floats [[gnu::vector_size(4 * SOFTFOCUS_LANES)]] = float;
using Ints [[gnu::vector_size(4 * SOFTFOCUS_LANES)]] = std::int32_t;
using Bits [[gnu::vector_size(4 * SOFTFOCUS_LANES)]] = std::uint32_t;
/// The result of a comparison: all bits of a lane, or none.
using Mask = Ints;

// --- memory; nothing need be aligned ---

SOFTFOCUS_INLINE Floats load(const float* from) {
  Floats v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
SOFTFOCUS_INLINE Ints load(const std::int32_t* from) {
  Ints v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
SOFTFOCUS_INLINE Bits load(const std::uint32_t* from) {
  Bits v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
SOFTFOCUS_INLINE void store(float* to, Floats v) { std::memcpy(to, &v, sizeof v); }
SOFTFOCUS_INLINE void store(std::int32_t* to, Ints v) { std::memcpy(to, &v, sizeof v); }
SOFTFOCUS_INLINE void store(std::uint32_t* to, Bits v) { std::memcpy(to, &v, sizeof v); }

/// Makes the compiler read a stored array from memory. Compilers prefer to keep it in a vector
/// register, but lanes that are used one by one come faster from memory.
template <class Array>
SOFTFOCUS_INLINE void keep_in_memory(Array& array) {
  asm volatile("" : "+m"(array));
}

/// The value in every lane. Not as a sum with 0, which would turn -0 into 0.
SOFTFOCUS_INLINE Floats splat(float value) {
#if SOFTFOCUS_LANES == 16
  return Floats{value, value, value, value, value, value, value, value,
                value, value, value, value, value, value, value, value};
#elif SOFTFOCUS_LANES == 8
  return Floats{value, value, value, value, value, value, value, value};
#else
  return Floats{value, value, value, value};
#endif
}
SOFTFOCUS_INLINE Ints splat(std::int32_t value) { return Ints{} + value; }
SOFTFOCUS_INLINE Bits splat(std::uint32_t value) { return Bits{} + value; }

/// 0, 1, 2, ...
SOFTFOCUS_INLINE Ints lane_numbers() {
#if SOFTFOCUS_LANES == 16
  return Ints{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
#elif SOFTFOCUS_LANES == 8
  return Ints{0, 1, 2, 3, 4, 5, 6, 7};
#else
  return Ints{0, 1, 2, 3};
#endif
}

// --- bits and choices ---

SOFTFOCUS_INLINE Bits as_bits(Floats v) { return (Bits)v; }
SOFTFOCUS_INLINE Bits as_bits(Ints v) { return (Bits)v; }
SOFTFOCUS_INLINE Floats as_floats(Bits v) { return (Floats)v; }
SOFTFOCUS_INLINE Ints as_ints(Bits v) { return (Ints)v; }
SOFTFOCUS_INLINE Ints as_ints(Floats v) { return (Ints)v; }

#if defined(__wasm_simd128__)
// `?:` would compare the mask with 0 once more.
SOFTFOCUS_INLINE Floats select(Mask mask, Floats yes, Floats no) {
  return (Floats)wasm_v128_bitselect((v128_t)yes, (v128_t)no, (v128_t)mask);
}
SOFTFOCUS_INLINE Ints select(Mask mask, Ints yes, Ints no) {
  return (Ints)wasm_v128_bitselect((v128_t)yes, (v128_t)no, (v128_t)mask);
}
#else
SOFTFOCUS_INLINE Floats select(Mask mask, Floats yes, Floats no) { return mask ? yes : no; }
SOFTFOCUS_INLINE Ints select(Mask mask, Ints yes, Ints no) { return mask ? yes : no; }
#endif
SOFTFOCUS_INLINE Bits select(Mask mask, Bits yes, Bits no) {
  return as_bits(select(mask, as_ints(yes), as_ints(no)));
}

/// Bit i is set if lane i is.
SOFTFOCUS_INLINE unsigned lane_bits(Mask mask) {
#if SOFTFOCUS_LANES == 16
  return _mm512_movepi32_mask((__m512i)mask);
#elif SOFTFOCUS_LANES == 8
  return static_cast<unsigned>(_mm256_movemask_ps((__m256)mask));
#elif defined(__SSE2__)
  return static_cast<unsigned>(_mm_movemask_ps((__m128)mask));
#elif defined(__wasm_simd128__)
  return wasm_i32x4_bitmask((v128_t)mask);
#else
  unsigned bits = 0;
  for (int i = 0; i < kLanes; ++i) bits |= (mask[i] != 0 ? 1u : 0u) << i;
  return bits;
#endif
}
/// Bit i is set if lane i is negative. On x86 and in WebAssembly it takes no comparison.
SOFTFOCUS_INLINE unsigned sign_bits(Ints v) {
#if SOFTFOCUS_LANES == 16 || SOFTFOCUS_LANES == 8 || defined(__SSE2__) || defined(__wasm_simd128__)
  return lane_bits(v);
#else
  return lane_bits(v < 0);
#endif
}
/// lane_bits(a == b), without the vector of a mask that compilers would make in between.
SOFTFOCUS_INLINE unsigned equal_lane_bits(Ints a, Ints b) {
#if SOFTFOCUS_LANES == 16
  return _mm512_cmpeq_epi32_mask((__m512i)a, (__m512i)b);
#else
  return lane_bits(a == b);
#endif
}
/// lane_bits(a <= b), likewise.
SOFTFOCUS_INLINE unsigned at_most_lane_bits(Bits a, Bits b) {
#if SOFTFOCUS_LANES == 16
  return _mm512_cmple_epu32_mask((__m512i)a, (__m512i)b);
#else
  return lane_bits(a <= b);
#endif
}
inline constexpr unsigned kAllLaneBits = (1u << SOFTFOCUS_LANES) - 1;
SOFTFOCUS_INLINE bool any(Mask mask) { return lane_bits(mask) != 0; }
SOFTFOCUS_INLINE bool all(Mask mask) { return lane_bits(mask) == kAllLaneBits; }

/// The lanes before the `count`th.
SOFTFOCUS_INLINE Mask first_lanes(int count) { return lane_numbers() < count; }

// AVX-512 is written in its maskz forms. g++ 12 compiles the others to the same, but warns of
// their lanes outside the mask, which are undefined.

// --- arithmetic ---

SOFTFOCUS_INLINE Floats absolute(Floats v) { return as_floats(as_bits(v) & 0x7FFFFFFFu); }
/// a < b ? a : b and a > b ? a : b: b where one is NaN.
SOFTFOCUS_INLINE Floats smaller(Floats a, Floats b) {
#if SOFTFOCUS_LANES == 16
  return (Floats)_mm512_maskz_min_ps(0xFFFF, (__m512)a, (__m512)b);
#elif SOFTFOCUS_LANES == 8
  return (Floats)_mm256_min_ps((__m256)a, (__m256)b);
#elif defined(__SSE2__)
  return (Floats)_mm_min_ps((__m128)a, (__m128)b);
#elif defined(__wasm_simd128__)
  return (Floats)wasm_f32x4_pmin((v128_t)b, (v128_t)a);
#else
  return a < b ? a : b;
#endif
}
SOFTFOCUS_INLINE Floats larger(Floats a, Floats b) {
#if SOFTFOCUS_LANES == 16
  return (Floats)_mm512_maskz_max_ps(0xFFFF, (__m512)a, (__m512)b);
#elif SOFTFOCUS_LANES == 8
  return (Floats)_mm256_max_ps((__m256)a, (__m256)b);
#elif defined(__SSE2__)
  return (Floats)_mm_max_ps((__m128)a, (__m128)b);
#elif defined(__wasm_simd128__)
  return (Floats)wasm_f32x4_pmax((v128_t)b, (v128_t)a);
#else
  return a > b ? a : b;
#endif
}
SOFTFOCUS_INLINE Ints smaller(Ints a, Ints b) { return a < b ? a : b; }
SOFTFOCUS_INLINE Ints larger(Ints a, Ints b) { return a > b ? a : b; }

/// Each lane as two signed numbers of 16 bits: both products, added.
SOFTFOCUS_INLINE Ints multiply_add_pairs(Ints a, Ints b) {
#if SOFTFOCUS_LANES == 16
  return (Ints)_mm512_maskz_madd_epi16(0xFFFF, (__m512i)a, (__m512i)b);
#elif SOFTFOCUS_LANES == 8
  return (Ints)_mm256_madd_epi16((__m256i)a, (__m256i)b);
#elif defined(__SSE2__)
  return (Ints)_mm_madd_epi16((__m128i)a, (__m128i)b);
#elif defined(__wasm_simd128__)
  return (Ints)wasm_i32x4_dot_i16x8((v128_t)a, (v128_t)b);
#else
  return (a << 16 >> 16) * (b << 16 >> 16) + (a >> 16) * (b >> 16);
#endif
}

/// Their differences, modulo 2^16.
SOFTFOCUS_INLINE Ints subtract_pairs(Ints a, Ints b) {
  using Shorts [[gnu::vector_size(4 * SOFTFOCUS_LANES)]] = std::uint16_t;
  return (Ints)((Shorts)a - (Shorts)b);
}

SOFTFOCUS_INLINE Floats to_floats(Ints v) { return __builtin_convertvector(v, Floats); }
/// The integer part. Needs values that an int32 holds.
SOFTFOCUS_INLINE Ints truncate(Floats v) { return __builtin_convertvector(v, Ints); }

SOFTFOCUS_INLINE Floats square_root(Floats v) {
#if SOFTFOCUS_LANES == 16
  return (Floats)_mm512_maskz_sqrt_ps(0xFFFF, (__m512)v);
#elif SOFTFOCUS_LANES == 8
  return (Floats)_mm256_sqrt_ps((__m256)v);
#elif defined(__SSE2__)
  return (Floats)_mm_sqrt_ps((__m128)v);
#elif defined(__wasm_simd128__)
  return (Floats)wasm_f32x4_sqrt((v128_t)v);
#else
  for (int i = 0; i < kLanes; ++i) v[i] = std::sqrt(v[i]);
  return v;
#endif
}

/// 1 / v with a relative error of at most 1.5 2^-12, which differs between CPUs. Needs 2^-100 to
/// 2^100.
SOFTFOCUS_INLINE Floats rough_reciprocal(Floats v) {
#if SOFTFOCUS_LANES == 16
  return (Floats)_mm512_maskz_rcp14_ps(0xFFFF, (__m512)v);
#elif SOFTFOCUS_LANES == 8
  return (Floats)_mm256_rcp_ps((__m256)v);
#elif defined(__SSE2__)
  return (Floats)_mm_rcp_ps((__m128)v);
#else
  return 1.0f / v;
#endif
}

/// To the nearest whole number, ties to even.
SOFTFOCUS_INLINE Floats nearest(Floats v) {
#if SOFTFOCUS_LANES == 16
  return (Floats)_mm512_maskz_roundscale_ps(0xFFFF, (__m512)v,
                                            _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
#elif SOFTFOCUS_LANES == 8
  return (Floats)_mm256_round_ps((__m256)v, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
#elif defined(__wasm_simd128__)
  return (Floats)wasm_f32x4_nearest((v128_t)v);
#else
  // Floats from 2^23 on are whole. The sign is put back for the sake of -0.
  const Bits sign = as_bits(v) & 0x80000000u;
  const Floats whole = (absolute(v) + 0x1p23f) - 0x1p23f;
  return select(absolute(v) < 0x1p23f, as_floats(as_bits(whole) | sign), v);
#endif
}

SOFTFOCUS_INLINE Floats floor(Floats v) {
#if SOFTFOCUS_LANES == 16
  return (Floats)_mm512_maskz_roundscale_ps(0xFFFF, (__m512)v,
                                            _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC);
#elif SOFTFOCUS_LANES == 8
  return (Floats)_mm256_round_ps((__m256)v, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC);
#elif defined(__wasm_simd128__)
  return (Floats)wasm_f32x4_floor((v128_t)v);
#else
  const Floats whole = nearest(v);
  return whole - select(whole > v, splat(1.0f), splat(0.0f));
#endif
}

/// As in float_to_int.h: values that do not fit become the least integer.
SOFTFOCUS_INLINE Ints truncate_to_int(Floats v) {
#if SOFTFOCUS_LANES == 16
  return (Ints)_mm512_maskz_cvttps_epi32(0xFFFF, (__m512)v);
#elif SOFTFOCUS_LANES == 8
  return (Ints)_mm256_cvttps_epi32((__m256)v);
#elif defined(__SSE2__)
  return (Ints)_mm_cvttps_epi32((__m128)v);
#elif defined(__wasm_simd128__)
  const Ints nearest_that_fits = (Ints)wasm_i32x4_trunc_sat_f32x4((v128_t)v);
  return select(v < 0x1p31f, nearest_that_fits, splat(INT32_MIN));
#else
  const Mask fits = (v >= -0x1p31f) & (v < 0x1p31f);
  return select(fits, truncate(select(fits, v, splat(0.0f))), splat(INT32_MIN));
#endif
}
SOFTFOCUS_INLINE Ints round_to_int(Floats v) { return truncate_to_int(nearest(v)); }

/// a b + c, rounded once.
SOFTFOCUS_INLINE Floats fused_multiply_add(Floats a, Floats b, Floats c) {
#if SOFTFOCUS_LANES == 16
  return (Floats)_mm512_fmadd_ps((__m512)a, (__m512)b, (__m512)c);
#elif SOFTFOCUS_LANES == 8
  return (Floats)_mm256_fmadd_ps((__m256)a, (__m256)b, (__m256)c);
#else
  for (int i = 0; i < kLanes; ++i) c[i] = softfocus::fused_multiply_add(a[i], b[i], c[i]);
  return c;
#endif
}

/// v[index] in each lane. Needs 0 <= index < kLanes.
SOFTFOCUS_INLINE Floats pick(Floats v, Ints index) {
#ifdef __clang__
#if SOFTFOCUS_LANES == 16
  return (Floats)_mm512_permutexvar_ps((__m512i)index, (__m512)v);
#elif SOFTFOCUS_LANES == 8
  return (Floats)_mm256_permutevar8x32_ps((__m256)v, (__m256i)index);
#elif defined(__wasm_simd128__)
  const Bits bytes = as_bits(index) * 0x04040404u + 0x03020100u;
  return (Floats)wasm_i8x16_swizzle((v128_t)v, (v128_t)bytes);
#else
  return Floats{v[index[0]], v[index[1]], v[index[2]], v[index[3]]};
#endif
#else
  return __builtin_shuffle(v, index);
#endif
}

// --- gathers: base[index] in the lanes of the mask, 0 in the others ---

SOFTFOCUS_INLINE Ints gather(const std::int32_t* base, Ints index, Mask mask) {
#if SOFTFOCUS_LANES == 16
  return (Ints)_mm512_mask_i32gather_epi32(
      _mm512_setzero_si512(), _mm512_movepi32_mask((__m512i)mask), (__m512i)index, base, 4);
#elif SOFTFOCUS_LANES == 8
  return (Ints)_mm256_mask_i32gather_epi32(_mm256_setzero_si256(), base, (__m256i)index,
                                           (__m256i)mask, 4);
#elif defined(__wasm_simd128__)
  // The others read base[0]: cheaper than a jump a lane. WebAssembly can read any address below
  // the memory's end, 0 too.
  const Ints safe = index & mask;
  return Ints{base[safe[0]], base[safe[1]], base[safe[2]], base[safe[3]]} & mask;
#else
  Ints v{};
  for (int i = 0; i < kLanes; ++i) {
    if (mask[i] != 0) v[i] = base[index[i]];
  }
  return v;
#endif
}
SOFTFOCUS_INLINE Floats gather(const float* base, Ints index, Mask mask) {
#if SOFTFOCUS_LANES == 16
  return (Floats)_mm512_mask_i32gather_ps(_mm512_setzero_ps(), _mm512_movepi32_mask((__m512i)mask),
                                          (__m512i)index, base, 4);
#elif SOFTFOCUS_LANES == 8
  return (Floats)_mm256_mask_i32gather_ps(_mm256_setzero_ps(), base, (__m256i)index, (__m256)mask,
                                          4);
#elif defined(__wasm_simd128__)
  const Ints safe = index & mask;
  const Floats v{base[safe[0]], base[safe[1]], base[safe[2]], base[safe[3]]};
  return as_floats(as_bits(v) & as_bits(mask));
#else
  Floats v{};
  for (int i = 0; i < kLanes; ++i) {
    if (mask[i] != 0) v[i] = base[index[i]];
  }
  return v;
#endif
}

/// Pairs of numbers: base[2 index] and base[2 index + 1] of each lane.
struct IntPairs {
  Ints first, second;
};
template <std::size_t... lane>
SOFTFOCUS_INLINE IntPairs unzip_lanes(Ints lower, Ints upper, std::index_sequence<lane...>) {
  return {__builtin_shufflevector(lower, upper, (2 * lane)...),
          __builtin_shufflevector(lower, upper, (2 * lane + 1)...)};
}
#if SOFTFOCUS_LANES >= 8
SOFTFOCUS_INLINE long long pair_at(const std::int32_t* base, std::int32_t index) {
  long long pair;
  std::memcpy(&pair, base + 2 * static_cast<std::ptrdiff_t>(index), sizeof pair);
  return pair;
}
/// Of half of the lanes.
SOFTFOCUS_INLINE Ints pairs_at(const std::int32_t* base, const std::int32_t* index) {
#if SOFTFOCUS_LANES == 16
  return (Ints)_mm512_setr_epi64(pair_at(base, index[0]), pair_at(base, index[1]),
                                 pair_at(base, index[2]), pair_at(base, index[3]),
                                 pair_at(base, index[4]), pair_at(base, index[5]),
                                 pair_at(base, index[6]), pair_at(base, index[7]));
#else
  return (Ints)_mm256_setr_epi64x(pair_at(base, index[0]), pair_at(base, index[1]),
                                  pair_at(base, index[2]), pair_at(base, index[3]));
#endif
}
#endif
// One by one: a load a lane takes less time than a gather instruction, which processors of several
// makers split up or have slowed down.
SOFTFOCUS_INLINE IntPairs gather_pairs(const std::int32_t* base, Ints indices) {
#if SOFTFOCUS_LANES >= 8
  std::int32_t index[kLanes];
  std::memcpy(index, &indices, sizeof index);
  return unzip_lanes(pairs_at(base, index), pairs_at(base, index + kLanes / 2),
                     std::make_index_sequence<kLanes>{});
#else
  IntPairs v{};
  for (int i = 0; i < kLanes; ++i) {
    v.first[i] = base[2 * indices[i]];
    v.second[i] = base[2 * indices[i] + 1];
  }
  return v;
#endif
}

// --- compression: the lanes of a mask moved to the front ---

/// A mask as compress() needs it, made once for many vectors.
#if SOFTFOCUS_LANES == 16
using Compression = __mmask16;
SOFTFOCUS_INLINE Compression compression(Mask mask) { return _mm512_movepi32_mask((__m512i)mask); }
SOFTFOCUS_INLINE Floats compress(Floats v, Compression kept) {
  return (Floats)_mm512_maskz_compress_ps(kept, (__m512)v);
}
SOFTFOCUS_INLINE Ints compress(Ints v, Compression kept) {
  return (Ints)_mm512_maskz_compress_epi32(kept, (__m512i)v);
}
#else
using Compression = Ints;  // which lane comes to each place
#if SOFTFOCUS_LANES == 4
// By the mask's bits.
alignas(16) inline constexpr std::int32_t kKeptLanes[16][4] = {
    {0, 0, 0, 0}, {0, 0, 0, 0}, {1, 0, 0, 0}, {0, 1, 0, 0}, {2, 0, 0, 0}, {0, 2, 0, 0},
    {1, 2, 0, 0}, {0, 1, 2, 0}, {3, 0, 0, 0}, {0, 3, 0, 0}, {1, 3, 0, 0}, {0, 1, 3, 0},
    {2, 3, 0, 0}, {0, 2, 3, 0}, {1, 2, 3, 0}, {0, 1, 2, 3}};
SOFTFOCUS_INLINE Compression compression(Mask mask) { return load(kKeptLanes[lane_bits(mask)]); }
#else
// A byte a place, by the mask's bits.
struct KeptLanes {
  std::uint64_t places[256];
};
constexpr KeptLanes find_kept_lanes() {
  KeptLanes kept{};
  for (unsigned bits = 0; bits < 256; ++bits) {
    int count = 0;
    for (unsigned lane = 0; lane < 8; ++lane) {
      if ((bits >> lane & 1u) != 0) kept.places[bits] |= std::uint64_t{lane} << (8 * count++);
    }
  }
  return kept;
}
inline constexpr KeptLanes kKeptLanes = find_kept_lanes();
SOFTFOCUS_INLINE Compression compression(Mask mask) {
  return (Ints)_mm256_cvtepu8_epi32(
      _mm_cvtsi64_si128(static_cast<long long>(kKeptLanes.places[lane_bits(mask)])));
}
#endif
SOFTFOCUS_INLINE Floats compress(Floats v, Compression kept) { return pick(v, kept); }
SOFTFOCUS_INLINE Ints compress(Ints v, Compression kept) { return (Ints)pick((Floats)v, kept); }
#endif

// --- fours: vectors as kLanes / 4 times four lanes ---

/// In each four lanes the k-th is lane ik of `a` (0 to 3), or lane ik - 4 of `b` (4 to 7).
template <std::size_t i0, std::size_t i1, std::size_t i2, std::size_t i3, class Vector,
          std::size_t... lane>
SOFTFOCUS_INLINE Vector choose_lanes(Vector a, Vector b, std::index_sequence<lane...>) {
  constexpr std::size_t kFrom[4] = {i0, i1, i2, i3};
  return __builtin_shufflevector(
      a, b, ((lane & ~std::size_t{3}) + kFrom[lane & 3] % 4 + kFrom[lane & 3] / 4 * kLanes)...);
}
template <std::size_t i0, std::size_t i1, std::size_t i2, std::size_t i3, class Vector>
SOFTFOCUS_INLINE Vector fours_of(Vector a, Vector b) {
  return choose_lanes<i0, i1, i2, i3>(a, b, std::make_index_sequence<SOFTFOCUS_LANES>{});
}

/// In each four lanes, all become the one of that number.
template <std::size_t number, class Vector>
SOFTFOCUS_INLINE Vector spread(Vector v) {
  return fours_of<number, number, number, number>(v, v);
}

/// Each of the first kLanes / 4 lanes, four times.
template <std::size_t... lane>
SOFTFOCUS_INLINE Ints repeat_lanes(Ints v, std::index_sequence<lane...>) {
  return __builtin_shufflevector(v, v, (lane / 4)...);
}
SOFTFOCUS_INLINE Ints repeat_by_four(Ints v) {
  return repeat_lanes(v, std::make_index_sequence<SOFTFOCUS_LANES>{});
}

/// Four numbers from each of kLanes / 4 places, `offset` numbers past those pointed to.
SOFTFOCUS_INLINE Floats load_fours(const float* const* from, std::size_t offset) {
#if SOFTFOCUS_LANES == 16
  const __m512 first = _mm512_castps128_ps512(_mm_loadu_ps(from[0] + offset));
  const __m512 second = _mm512_maskz_insertf32x4(0xFFFF, first, _mm_loadu_ps(from[1] + offset), 1);
  const __m512 third = _mm512_maskz_insertf32x4(0xFFFF, second, _mm_loadu_ps(from[2] + offset), 2);
  return (Floats)_mm512_maskz_insertf32x4(0xFFFF, third, _mm_loadu_ps(from[3] + offset), 3);
#elif SOFTFOCUS_LANES == 8
  const __m256 first = _mm256_castps128_ps256(_mm_loadu_ps(from[0] + offset));
  return (Floats)_mm256_insertf128_ps(first, _mm_loadu_ps(from[1] + offset), 1);
#else
  return load(from[0] + offset);
#endif
}

/// In each four lanes, lane i of vector j and lane j of vector i change places.
SOFTFOCUS_INLINE void transpose_fours(Floats& v0, Floats& v1, Floats& v2, Floats& v3) {
  const Floats low01 = fours_of<0, 4, 1, 5>(v0, v1);
  const Floats low23 = fours_of<0, 4, 1, 5>(v2, v3);
  const Floats high01 = fours_of<2, 6, 3, 7>(v0, v1);
  const Floats high23 = fours_of<2, 6, 3, 7>(v2, v3);
  v0 = fours_of<0, 1, 4, 5>(low01, low23);
  v1 = fours_of<2, 3, 6, 7>(low01, low23);
  v2 = fours_of<0, 1, 4, 5>(high01, high23);
  v3 = fours_of<2, 3, 6, 7>(high01, high23);
}

// --- transposition ---

// Without loops, so that all vectors stay in registers.

// Swaps, in lanes and vectors at once, two blocks of `step` off the diagonal.
template <int step, class Vector, std::size_t... lane>
SOFTFOCUS_INLINE void swap_blocks(Vector& a, Vector& b, std::index_sequence<lane...>) {
  const Vector upper =
      __builtin_shufflevector(a, b, ((lane & step) != 0 ? lane + SOFTFOCUS_LANES - step : lane)...);
  b = __builtin_shufflevector(a, b, ((lane & step) != 0 ? lane + SOFTFOCUS_LANES : lane + step)...);
  a = upper;
}
template <int step, class Vector, std::size_t... pair>
SOFTFOCUS_INLINE void swap_all_blocks(Vector* v, std::index_sequence<pair...>) {
  // The first of pair i is i with a 0 inserted at the bit of the step.
  ((swap_blocks<step>(v[pair / step * step * 2 + pair % step],
                      v[pair / step * step * 2 + pair % step + step],
                      std::make_index_sequence<SOFTFOCUS_LANES>{})),
   ...);
}

/// In kLanes vectors, lane i of vector j and lane j of vector i change places.
template <class Vector>
SOFTFOCUS_INLINE void transpose(Vector* v) {
  using Pairs = std::make_index_sequence<SOFTFOCUS_LANES / 2>;
  if constexpr (kLanes > 8) swap_all_blocks<8>(v, Pairs{});
  if constexpr (kLanes > 4) swap_all_blocks<4>(v, Pairs{});
  swap_all_blocks<2>(v, Pairs{});
  swap_all_blocks<1>(v, Pairs{});
}

// --- halves, one in the low bits of each lane ---

/// half_to_float().
SOFTFOCUS_INLINE Floats half_to_float(Bits half) {
#if SOFTFOCUS_LANES == 16
  return (Floats)_mm512_maskz_cvtph_ps(0xFFFF, _mm512_maskz_cvtepi32_epi16(0xFFFF, (__m512i)half));
#elif SOFTFOCUS_LANES == 8
  const __m256i packed = _mm256_packus_epi32((__m256i)half, (__m256i)half);
  return (Floats)_mm256_cvtph_ps(_mm256_castsi256_si128(_mm256_permute4x64_epi64(packed, 0b1000)));
#else
  const Bits sign = (half & 0x8000u) << 16;
  const Bits magnitude = half & 0x7FFFu;
  const Bits quiet = select(magnitude > kHalfInfinity, splat(0x00400000u), splat(0u));
  const Bits special = 0x7F800000u | quiet | (magnitude & 0x3FFu) << 13;
  const Floats scaled = as_floats(magnitude << 13) * 0x1p112f;
  return as_floats(sign | select(magnitude >= kHalfInfinity, special, as_bits(scaled)));
#endif
}
/// kLanes halves side by side, as floats.
SOFTFOCUS_INLINE Floats load_halves(const std::uint16_t* from) {
#if SOFTFOCUS_LANES == 16
  return (Floats)_mm512_maskz_cvtph_ps(0xFFFF, _mm256_loadu_si256((const __m256i*)from));
#elif SOFTFOCUS_LANES == 8
  return (Floats)_mm256_cvtph_ps(_mm_loadu_si128((const __m128i*)from));
#elif defined(__wasm_simd128__)
  return half_to_float((Bits)wasm_u32x4_load16x4(from));
#else
  return half_to_float(Bits{from[0], from[1], from[2], from[3]});
#endif
}

/// swiftshader_half().
SOFTFOCUS_INLINE Bits swiftshader_half(Floats value) {
  const Bits sign = as_bits(value) >> 16 & 0x8000u;
  const Bits magnitude = as_bits(value) & 0x7FFFFFFFu;
  const Mask subnormal = magnitude < 0x38800000u;
  const Floats small = select(subnormal, as_floats(magnitude), splat(0.0f));
  const Bits base = select(subnormal, as_bits(truncate(small * 0x1p37f)), magnitude - (112u << 23));
  const Bits half = (base + 0xFFFu + (base >> 13 & 1u)) >> 13;
  return select(half > kHalfInfinity, splat(std::uint32_t{kHalfNan}), sign | half);
}

/// float_to_half().
template <HalfRounding rounding>
SOFTFOCUS_INLINE Bits float_to_half(Floats value) {
  if constexpr (rounding == HalfRounding::swiftshader) return swiftshader_half(value);
#if SOFTFOCUS_LANES >= 8
  constexpr int kRounding =
      rounding == HalfRounding::nearest_even ? _MM_FROUND_TO_NEAREST_INT : _MM_FROUND_TO_ZERO;
#if SOFTFOCUS_LANES == 16
  const Bits half = (Bits)_mm512_maskz_cvtepu16_epi32(
      0xFFFF, _mm512_maskz_cvtps_ph(0xFFFF, (__m512)value, kRounding));
#else
  const Bits half = (Bits)_mm256_cvtepu16_epi32(_mm256_cvtps_ph((__m256)value, kRounding));
#endif
  return select(value == value, half, splat(std::uint32_t{kHalfNan}));
#else
  constexpr bool kNearest = rounding == HalfRounding::nearest_even;
  const Bits sign = as_bits(value) >> 16 & 0x8000u;
  const Bits magnitude = as_bits(value) & 0x7FFFFFFFu;
  // The exponent's bias goes from 127 to 15; a carry from rounding runs up to infinity.
  Bits normal = magnitude - (112u << 23);
  if constexpr (kNearest) normal += 0xFFFu + (normal >> 13 & 1u);
  normal >>= 13;
  // A subnormal half counts 2^-24, as the mantissa of 1/2 does.
  Bits subnormal;
  if constexpr (kNearest) {
    subnormal = as_bits(as_floats(magnitude) + 0.5f) - 0x3F000000u;
  } else {
    const Bits small = select(magnitude < 0x38800000u, magnitude, splat(0u));
    subnormal = as_bits(truncate(as_floats(small) * 0x1p24f));
  }
  Bits half = select(magnitude < 0x38800000u, subnormal, normal);
  half = select(magnitude >= 0x47800000u,
                splat(std::uint32_t{kNearest ? kHalfInfinity : kHalfLargest}), half);
  half = select(magnitude >= 0x7F800000u, splat(std::uint32_t{kHalfInfinity}), half);
  return select(magnitude > 0x7F800000u, splat(std::uint32_t{kHalfNan}), sign | half);
#endif
}

#if SOFTFOCUS_LANES >= 8
/// Every NaN as the one that is stored (half.h).
SOFTFOCUS_INLINE Floats with_plain_nan(Floats v) {
  return select(v == v, v, as_floats(splat(std::uint32_t{0x7FC00000u})));
}

/// kLanes halves side by side, in words of four.
using HalfVector [[gnu::vector_size(2 * SOFTFOCUS_LANES)]] = std::uint64_t;

/// float_to_half() of with_plain_nan().
template <HalfRounding rounding>
SOFTFOCUS_INLINE HalfVector to_halves(Floats value) {
  static_assert(rounding != HalfRounding::swiftshader);
  constexpr int kRounding =
      rounding == HalfRounding::nearest_even ? _MM_FROUND_TO_NEAREST_INT : _MM_FROUND_TO_ZERO;
#if SOFTFOCUS_LANES == 16
  return (HalfVector)_mm512_maskz_cvtps_ph(0xFFFF, (__m512)value, kRounding);
#else
  return (HalfVector)_mm256_cvtps_ph((__m256)value, kRounding);
#endif
}
#endif

// --- pixels of RGBA16F ---

/// The channels of kLanes pixels, as halves.
struct HalfTexels {
  Bits r, g, b, a;
};

SOFTFOCUS_INLINE HalfTexels load_half_texels(const std::uint16_t* from) {
  // A pixel is two words of two halves; on big-endian machines the first is the upper.
  Bits first, second;
  std::memcpy(&first, from, sizeof first);
  std::memcpy(&second, from + 2 * kLanes, sizeof second);
#if SOFTFOCUS_LANES == 16
  const Bits rg = (Bits)__builtin_shufflevector(first, second, 0, 2, 4, 6, 8, 10, 12, 14, 16, 18,
                                                20, 22, 24, 26, 28, 30);
  const Bits ba = (Bits)__builtin_shufflevector(first, second, 1, 3, 5, 7, 9, 11, 13, 15, 17, 19,
                                                21, 23, 25, 27, 29, 31);
#elif SOFTFOCUS_LANES == 8
  const Bits rg = (Bits)__builtin_shufflevector(first, second, 0, 2, 4, 6, 8, 10, 12, 14);
  const Bits ba = (Bits)__builtin_shufflevector(first, second, 1, 3, 5, 7, 9, 11, 13, 15);
#else
  const Bits rg = (Bits)__builtin_shufflevector(first, second, 0, 2, 4, 6);
  const Bits ba = (Bits)__builtin_shufflevector(first, second, 1, 3, 5, 7);
#endif
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
  return {rg >> 16, rg & 0xFFFFu, ba >> 16, ba & 0xFFFFu};
#else
  return {rg & 0xFFFFu, rg >> 16, ba & 0xFFFFu, ba >> 16};
#endif
}

/// kLanes pixels as they lie in memory: the first half of them, then the second.
struct TexelWords {
  Bits first, second;
};
SOFTFOCUS_INLINE TexelWords interleave(const HalfTexels& texels) {
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
  const Bits rg = texels.r << 16 | texels.g;
  const Bits ba = texels.b << 16 | texels.a;
#else
  const Bits rg = texels.r | texels.g << 16;
  const Bits ba = texels.b | texels.a << 16;
#endif
#if SOFTFOCUS_LANES == 16
  const Bits first =
      (Bits)__builtin_shufflevector(rg, ba, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
  const Bits second = (Bits)__builtin_shufflevector(rg, ba, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28,
                                                    13, 29, 14, 30, 15, 31);
#elif SOFTFOCUS_LANES == 8
  const Bits first = (Bits)__builtin_shufflevector(rg, ba, 0, 8, 1, 9, 2, 10, 3, 11);
  const Bits second = (Bits)__builtin_shufflevector(rg, ba, 4, 12, 5, 13, 6, 14, 7, 15);
#else
  const Bits first = (Bits)__builtin_shufflevector(rg, ba, 0, 4, 1, 5);
  const Bits second = (Bits)__builtin_shufflevector(rg, ba, 2, 6, 3, 7);
#endif
  return {first, second};
}

SOFTFOCUS_INLINE void store_texel_words(std::uint16_t* to, const TexelWords& words) {
  std::memcpy(to, &words.first, sizeof words.first);
  std::memcpy(to + 2 * kLanes, &words.second, sizeof words.second);
}
SOFTFOCUS_INLINE void store_half_texels(std::uint16_t* to, const HalfTexels& texels) {
  store_texel_words(to, interleave(texels));
}

/// Pixels of RG16F.
SOFTFOCUS_INLINE void store_half_pairs(std::uint16_t* to, Bits r, Bits g) {
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
  const Bits pairs = r << 16 | g;
#else
  const Bits pairs = r | g << 16;
#endif
  std::memcpy(to, &pairs, sizeof pairs);
}
struct HalfPairs {
  Bits r, g;
};
SOFTFOCUS_INLINE HalfPairs load_half_pairs(const std::uint16_t* from) {
  Bits pairs;
  std::memcpy(&pairs, from, sizeof pairs);
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
  return {pairs >> 16, pairs & 0xFFFFu};
#else
  return {pairs & 0xFFFFu, pairs >> 16};
#endif
}

/// A store past the caches if the CPU can, for pixels that are not read again soon. Needs an
/// address that is a multiple of a vector's size, and finish_streaming() before another thread
/// reads.
SOFTFOCUS_INLINE void stream_texel_words(std::uint16_t* to, const TexelWords& words) {
#if SOFTFOCUS_LANES == 16
  _mm512_stream_si512((__m512i*)to, (__m512i)words.first);
  _mm512_stream_si512((__m512i*)(to + 2 * kLanes), (__m512i)words.second);
#elif SOFTFOCUS_LANES == 8
  _mm256_stream_si256((__m256i*)to, (__m256i)words.first);
  _mm256_stream_si256((__m256i*)(to + 2 * kLanes), (__m256i)words.second);
#elif defined(__SSE2__)
  _mm_stream_si128((__m128i*)to, (__m128i)words.first);
  _mm_stream_si128((__m128i*)(to + 2 * kLanes), (__m128i)words.second);
#else
  store_texel_words(to, words);
#endif
}
SOFTFOCUS_INLINE void stream_bits(void* to, Bits v) {
#if SOFTFOCUS_LANES == 16
  _mm512_stream_si512((__m512i*)to, (__m512i)v);
#elif SOFTFOCUS_LANES == 8
  _mm256_stream_si256((__m256i*)to, (__m256i)v);
#elif defined(__SSE2__)
  _mm_stream_si128((__m128i*)to, (__m128i)v);
#else
  std::memcpy(to, &v, sizeof v);
#endif
}
SOFTFOCUS_INLINE void finish_streaming() {
#if defined(__SSE2__)
  _mm_sfence();
#endif
}

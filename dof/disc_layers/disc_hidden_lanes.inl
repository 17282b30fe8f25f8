// What the kernels of the search for hidden things share. Needs picture_lanes.inl.

// Numbers of 16 bits. g++ 12 converts wide vectors of them by halves in memory.
using ShortLanes [[gnu::vector_size(2 * SOFTFOCUS_LANES)]] = std::uint16_t;
SOFTFOCUS_INLINE void store_shorts(std::uint16_t* to, Ints v) {
#if SOFTFOCUS_LANES == 16
  const ShortLanes shorts = (ShortLanes)_mm512_maskz_cvtepi32_epi16(0xFFFF, (__m512i)v);
#elif SOFTFOCUS_LANES == 8
  const __m256i pairs = _mm256_permute4x64_epi64(_mm256_packus_epi32((__m256i)v, (__m256i)v), 8);
  const ShortLanes shorts = (ShortLanes)_mm256_castsi256_si128(pairs);
#else
  const ShortLanes shorts = __builtin_convertvector(v, ShortLanes);
#endif
  std::memcpy(to, &shorts, sizeof shorts);
}
SOFTFOCUS_INLINE Ints load_shorts(const std::uint16_t* from) {
  ShortLanes shorts;
  std::memcpy(&shorts, from, sizeof shorts);
#if SOFTFOCUS_LANES == 16
  return (Ints)_mm512_maskz_cvtepu16_epi32(0xFFFF, (__m256i)shorts);
#elif SOFTFOCUS_LANES == 8
  return (Ints)_mm256_cvtepu16_epi32((__m128i)shorts);
#else
  return __builtin_convertvector(shorts, Ints);
#endif
}

inline constexpr int kVectors = kStrip / kLanes;  // of a strip

// The step by which something farther than a radius must lie behind it.
SOFTFOCUS_INLINE Floats step_behind(Floats radius) { return 1.0f + 0.25f * absolute(radius); }

SOFTFOCUS_INLINE const std::uint16_t* texel_row(const ConstImageView& picture, int y) {
  return reinterpret_cast<const std::uint16_t*>(picture.texels + y * picture.stride_bytes);
}

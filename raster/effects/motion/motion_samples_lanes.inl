// motion_samples.h for kLanes pixels at once.

SOFTFOCUS_INLINE Bits jitter_bit_lanes(Bits x, Bits y) {
  return (x * kJitterX + y * kJitterY) >> 8;
}
SOFTFOCUS_INLINE Floats jitter_lanes(Ints x, int y) {
  return to_floats(as_ints(jitter_bit_lanes(as_bits(x), splat(static_cast<std::uint32_t>(y))))) *
         0x1p-24f;
}

/// A texel of halves, from its two words.
struct FourFloats {
  Floats r, g, b, a;
};
SOFTFOCUS_INLINE FourFloats gather_texels(const BlurSource& from, Ints x, Ints y) {
  const IntPairs words = gather_pairs(from.texels, y * from.stride + x);
  const Bits first = as_bits(words.first), second = as_bits(words.second);
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
  return {half_to_float(first >> 16), half_to_float(first & 0xFFFFu), half_to_float(second >> 16),
          half_to_float(second & 0xFFFFu)};
#else
  return {half_to_float(first & 0xFFFFu), half_to_float(first >> 16),
          half_to_float(second & 0xFFFFu), half_to_float(second >> 16)};
#endif
}

/// pixel_at(), whose floor is the cut below once nothing is below 0.
SOFTFOCUS_INLINE Ints place_lanes(Floats at, Floats moved, int size) {
  const Floats place = larger((at + moved) + 0.5f, splat(0.0f));
  return truncate(smaller(place, splat(static_cast<float>(size - 1))));
}

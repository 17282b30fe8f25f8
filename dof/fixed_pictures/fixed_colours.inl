// Colours of either format on the lines of fixed_line.inl, and sums of them. Colours of bytes
// have 10 bits, and their sums 32; a half is an integer in units of 2^-24, and its sums have 64
// bits (dof/fixed/stream_half.cpp).

/// Weight and colours, each times a weight.
template <class Sum>
struct FixedSums {
  Bits weight;
  Sum r, g, b;
};

/// A weight, from the two parts that a word of the table holds.
SOFTFOCUS_INLINE Ints split_weight(Ints word) { return word & kSplitMask; }
SOFTFOCUS_INLINE Bits joined_weight(Ints split) {
  return as_bits(multiply_add_pairs(split, splat(1 << (16 + kSplitBits) | 1)));
}

// --- colours of 10 bits ---

SOFTFOCUS_INLINE Bits kept(Bits sum, Mask mask) { return sum & as_bits(mask); }
SOFTFOCUS_INLINE void load_sum(const std::uint32_t* from, Bits& sum) { sum = load(from); }
SOFTFOCUS_INLINE void store_sum(std::uint32_t* to, Bits sum) { store(to, sum); }

/// floor(sum leak), leak Q1.15, sum below 2^31.
SOFTFOCUS_INLINE Bits leaked(Bits sum, Bits leak) {
  return (sum >> 15) * leak + ((sum & 0x7FFFu) * leak >> 15);
}

/// A word a pixel, red in the lowest bits.
struct SmallColours {
  static constexpr int kWords = kSmallColourWords;
  static constexpr int kSumVectors = kSmallSumVectors;
  using Sum = Bits;
  using Pixels = Bits;

  SOFTFOCUS_INLINE static Pixels load_pixels(const std::uint32_t* words) { return load(words); }

  /// A colour times a weight, c l + 2^5 c h: 2^5 c has 15 bits.
  SOFTFOCUS_INLINE static Bits times(Bits c, Ints split) {
    return as_bits(multiply_add_pairs(as_ints(c | c << (16 + kSplitBits)), split));
  }
  SOFTFOCUS_INLINE static FixedSums<Bits> weighed(Ints word, Pixels colour) {
    const Ints split = split_weight(word);
    return {joined_weight(split), times(colour & 0x3FFu, split),
            times(colour >> 10 & 0x3FFu, split), times(colour >> 20, split)};
  }

  /// floor(sum / weight), below 1024. The reciprocal is too small by 2^-13 to 7 2^-13 of itself:
  /// more than floats round away, less than a step. So the estimate is right or one less, and the
  /// remainder tells which.
  SOFTFOCUS_INLINE static Bits quotient(Bits sum, Bits weight, Floats reciprocal) {
    const Ints estimate = truncate(to_floats(as_ints(sum)) * reciprocal);
    const Ints rest = as_ints(sum) - estimate * as_ints(weight);
    return as_bits(select(rest >= as_ints(weight), estimate + 1, estimate));
  }

  /// Stores colours of 10 bits, or after the last pass of 8.
  template <bool last>
  SOFTFOCUS_INLINE static void store_quotients(std::uint32_t* words, const FixedSums<Bits>& sums) {
    constexpr int kBits = last ? 8 : 10;
    constexpr int kCut = 10 - kBits;
    const Bits weight = sums.weight;
    const Floats reciprocal = rough_reciprocal(to_floats(as_ints(weight))) * (1.0f - 0x1p-11f);
    const Bits half = last ? weight << 1 : weight >> 1;
    store(words, quotient((sums.r + half) >> kCut, weight, reciprocal) |
                     quotient((sums.g + half) >> kCut, weight, reciprocal) << kBits |
                     quotient((sums.b + half) >> kCut, weight, reciprocal) << 2 * kBits);
  }

  /// store_quotients() of pixels that no neighbour adds to.
  template <bool last>
  SOFTFOCUS_INLINE static void store_unchanged(std::uint32_t* words, const std::uint32_t* from) {
    const Bits colour = load(from);
    if constexpr (!last) {
      store(words, colour);
    } else {
      const Bits rounded = colour + (2u | 2u << 10 | 2u << 20);  // up to 1022: no carry
      store(words, (rounded >> 2 & 0xFFu) | (rounded >> 4 & 0xFF00u) | (rounded >> 6 & 0xFF0000u));
    }
  }
};

// --- halves ---

/// Sums of 64 bits, which wrap round, of the even lanes and of the odd ones: where products of
/// 32 bits come out. (On big-endian machines "even" are the lanes of odd number.)
using Longs [[gnu::vector_size(4 * SOFTFOCUS_LANES)]] = std::uint64_t;
using LongMask [[gnu::vector_size(4 * SOFTFOCUS_LANES)]] = std::int64_t;
struct WideSum {
  Longs even, odd;
};

SOFTFOCUS_INLINE WideSum operator+(const WideSum& a, const WideSum& b) {
  return {a.even + b.even, a.odd + b.odd};
}
SOFTFOCUS_INLINE WideSum operator-(const WideSum& a, const WideSum& b) {
  return {a.even - b.even, a.odd - b.odd};
}

// Numbers of even lanes lie in the low bits of a long, those of odd ones in the high bits.
SOFTFOCUS_INLINE Longs low_bits(Longs v) { return v & 0xFFFFFFFFu; }
SOFTFOCUS_INLINE WideSum kept(const WideSum& sum, Mask mask) {
  const Longs odd = (Longs)mask >> 32, even = low_bits((Longs)mask);
  return {sum.even & (even << 32 | even), sum.odd & (odd << 32 | odd)};
}
SOFTFOCUS_INLINE void load_sum(const std::uint32_t* from, WideSum& sum) {
  sum = {(Longs)load(from), (Longs)load(from + kLanes)};
}
SOFTFOCUS_INLINE void store_sum(std::uint32_t* to, const WideSum& sum) {
  store(to, (Bits)sum.even);
  store(to + kLanes, (Bits)sum.odd);
}

/// Products of the low 32 bits.
SOFTFOCUS_INLINE Longs multiply_low(Longs a, Longs b) {
#if SOFTFOCUS_LANES == 16
  return (Longs)_mm512_maskz_mul_epu32(0xFF, (__m512i)a, (__m512i)b);
#elif SOFTFOCUS_LANES == 8
  return (Longs)_mm256_mul_epu32((__m256i)a, (__m256i)b);
#elif defined(__SSE2__)
  return (Longs)_mm_mul_epu32((__m128i)a, (__m128i)b);
#else
  return low_bits(a) * low_bits(b);
#endif
}
/// Products of the low 32 bits, a signed; 0 <= b.
SOFTFOCUS_INLINE Longs multiply_low_signed(Longs a, Longs b) {
#if SOFTFOCUS_LANES == 16
  return (Longs)_mm512_maskz_mul_epi32(0xFF, (__m512i)a, (__m512i)b);
#elif SOFTFOCUS_LANES == 8
  return (Longs)_mm256_mul_epi32((__m256i)a, (__m256i)b);
#else
  const Longs below_zero = (Longs)((Ints)a < 0);
  return multiply_low(a, b) - ((b & below_zero) << 32);
#endif
}

/// a b modulo 2^64, b below 2^32.
SOFTFOCUS_INLINE Longs multiply(Longs a, Longs b) {
  return multiply_low(a, b) + (multiply_low(a >> 32, b) << 32);
}
SOFTFOCUS_INLINE Longs shifted_down_signed(Longs sum, int bits) {
  return (Longs)((LongMask)sum >> bits);
}
SOFTFOCUS_INLINE Longs leaked(Longs sum, Longs leak) {
  return multiply(shifted_down_signed(sum, 15), leak) + (multiply_low(sum & 0x7FFFu, leak) >> 15);
}
/// floor(sum leak), leak Q1.15.
SOFTFOCUS_INLINE WideSum leaked(const WideSum& sum, Bits leak) {
  const Longs leaks = (Longs)leak;
  return {leaked(sum.even, low_bits(leaks)), leaked(sum.odd, leaks >> 32)};
}

/// A finite half as mantissa 2^shift, in units of 2^-24; the mantissa has 11 bits and a sign.
struct HalfParts {
  Longs mantissa_even, mantissa_odd, shift_even, shift_odd;
};
SOFTFOCUS_INLINE HalfParts parts_of_half(Bits half) {
  const Bits exponent = half >> 10 & 31u;
  const Mask normal = exponent != 0u;
  const Ints magnitude = as_ints((half & 0x3FFu) | (as_bits(normal) & 0x400u));
  const Ints sign = as_ints(half << 16) >> 31;
  const Longs mantissa = (Longs)((magnitude ^ sign) - sign);
  const Longs shift = (Longs)(exponent + as_bits(normal));
  return {mantissa, mantissa >> 32, low_bits(shift), shift >> 32};
}

/// A vector of 32-bit lanes, from its even and odd ones.
SOFTFOCUS_INLINE Ints joined(Longs even, Longs odd) { return (Ints)(low_bits(even) | odd << 32); }

/// Two words a pixel, red in the lower half of the first, green in the upper, and blue.
struct HalfColours {
  static constexpr int kWords = kHalfColourWords;
  static constexpr int kSumVectors = kHalfSumVectors;
  using Sum = WideSum;
  struct Pixels {
    HalfParts r, g, b;
  };

  SOFTFOCUS_INLINE static Pixels load_pixels(const std::uint32_t* words) {
    const Bits rg = load(words);
    return {parts_of_half(rg & 0xFFFFu), parts_of_half(rg >> 16),
            parts_of_half(load(words + kLanes))};
  }

  SOFTFOCUS_INLINE static WideSum times(const HalfParts& half, Longs weight) {
    return {multiply_low_signed(half.mantissa_even, weight) << half.shift_even,
            multiply_low_signed(half.mantissa_odd, weight >> 32) << half.shift_odd};
  }
  SOFTFOCUS_INLINE static FixedSums<WideSum> weighed(Ints word, const Pixels& colour) {
    const Bits weight = joined_weight(split_weight(word));
    const Longs longs = (Longs)weight;
    return {weight, times(colour.r, longs), times(colour.g, longs), times(colour.b, longs)};
  }

  /// The half nearest to sum / weight, ties to even; the sign is the sum's.
  ///
  /// In units of 2^-25 the quotient's magnitude is q = 2 |sum| / weight, below 2^41. We need
  /// n = floor(q / 2^shift), of 12 bits: one more than a half has room for. Floats find q too
  /// small by at most 2^-19 of it (after a Newton step the reciprocal is wrong by less than 2^-21;
  /// then it is made smaller by 2^-20). So n is right or one less, and the remainder tells which.
  /// If n becomes 4096 by that, half and remainder still mean the same.
  SOFTFOCUS_INLINE static Bits quotient(const WideSum& sum, Longs weight, Floats reciprocal) {
    const Longs sign_even = (Longs)((LongMask)sum.even < 0);
    const Longs sign_odd = (Longs)((LongMask)sum.odd < 0);
    const Longs twice_even = ((sum.even ^ sign_even) - sign_even) << 1;
    const Longs twice_odd = ((sum.odd ^ sign_odd) - sign_odd) << 1;
    // The lower 31 bits, and the bits above: each below 2^31.
    const Ints lower = joined(twice_even, twice_odd) & INT32_MAX;
    const Ints upper = joined(twice_even >> 31, twice_odd >> 31);
    const Floats q = (to_floats(upper) * 0x1p31f + to_floats(lower)) * reciprocal;
    const Ints shift = larger(as_ints(as_bits(q) >> 23) - (127 + 11), splat(0));
    const Longs n = (Longs)truncate(q * as_floats(as_bits(127 - shift) << 23));
    const Longs shift_even = low_bits((Longs)shift), shift_odd = (Longs)shift >> 32;
    const Longs weight_even = low_bits(weight), weight_odd = weight >> 32;
    const Longs rest_even = twice_even - (multiply_low(n, weight_even) << shift_even);
    const Longs rest_odd = twice_odd - (multiply_low(n >> 32, weight_odd) << shift_odd);
    const Longs step_even = weight_even << shift_even, step_odd = weight_odd << shift_odd;
    // All are below 2^62, so that signed comparisons serve.
    const LongMask one_more_even = (LongMask)rest_even >= (LongMask)step_even;
    const LongMask one_more_odd = (LongMask)rest_odd >= (LongMask)step_odd;
    const LongMask inexact_even = rest_even != (step_even & (Longs)one_more_even);
    const LongMask inexact_odd = rest_odd != (step_odd & (Longs)one_more_odd);
    const Ints inexact = joined((Longs)inexact_even, (Longs)inexact_odd);
    const Ints found = (Ints)n - joined((Longs)one_more_even, (Longs)one_more_odd);
    const Ints up = found & (inexact | found >> 1) & 1;
    // A carry runs into the exponent (stream_half.cpp).
    const Ints code = smaller((found >> 1) + up + (shift << 10), splat(std::int32_t{kHalfLargest}));
    return as_bits(code | (joined(sign_even, sign_odd) & 0x8000));
  }

  template <bool last>
  SOFTFOCUS_INLINE static void store_quotients(std::uint32_t* words,
                                               const FixedSums<WideSum>& sums) {
    const Floats weight = to_floats(as_ints(sums.weight));
    const Floats rough = rough_reciprocal(weight);
    const Floats reciprocal = rough * (2.0f - weight * rough) * (1.0f - 0x1p-20f);
    const Longs weights = (Longs)sums.weight;
    store(words, quotient(sums.r, weights, reciprocal) | quotient(sums.g, weights, reciprocal)
                                                             << 16);
    store(words + kLanes, quotient(sums.b, weights, reciprocal));
  }

  // A quotient of 0 is +0.
  SOFTFOCUS_INLINE static Bits without_sign_of_zero(Bits half) {
    return select(half == 0x8000u, splat(0u), half);
  }
  template <bool last>
  SOFTFOCUS_INLINE static void store_unchanged(std::uint32_t* words, const std::uint32_t* from) {
    const Bits rg = load(from);
    store(words, without_sign_of_zero(rg & 0xFFFFu) | without_sign_of_zero(rg >> 16) << 16);
    store(words + kLanes, without_sign_of_zero(load(from + kLanes)));
  }
};

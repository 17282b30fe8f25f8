// RGBA16F on the lines of dof/fixed_pictures/fixed_line_kernels.inl: a half is an integer in units of 2^-24,
// and sums of them have 64 bits (dof/fixed/stream_half.cpp).

/// Numbers of 64 bits, which wrap round: those of even lanes, and of odd ones. So products of
/// 32 bits come out where they belong. (On big-endian machines even lanes are here those whose
/// number is odd.)
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
/// The same of signed numbers. Needs 0 <= b.
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

/// Numbers 0, 1 or 2 and so on of 32 bits, from those of even and of odd lanes.
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

  /// The half nearest to sum / weight, a tie going to the even one; the sign is the sum's.
  ///
  /// In units of 2^-25 the magnitude of the quotient is q = 2 |sum| / weight, below 2^41. What
  /// is sought is n = floor(q / 2^shift) of at most 12 bits, the last of which a half has no room
  /// for. In floats q is found too small by at most 2^-19 of it (the reciprocal is wrong by less
  /// than 2^-21 after a Newton step, and then made smaller by 2^-20): n is right or less by one,
  /// and the remainder tells. Where it becomes 4096 thereby, half and rest mean the same.
  SOFTFOCUS_INLINE static Bits quotient(const WideSum& sum, Longs weight, Floats reciprocal) {
    const Longs sign_even = (Longs)((LongMask)sum.even < 0);
    const Longs sign_odd = (Longs)((LongMask)sum.odd < 0);
    const Longs twice_even = ((sum.even ^ sign_even) - sign_even) << 1;
    const Longs twice_odd = ((sum.odd ^ sign_odd) - sign_odd) << 1;
    // The lower 31 bits, and those above: below 2^31 too.
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

  // Of 0 the sign is lost.
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

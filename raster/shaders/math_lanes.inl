// The transcendental functions of GLSL on lanes. Each operation rounds once, none is fused, so that
// every unit has the same bits. What a lane gets does not depend on the other lanes: branches on
// any() lead to code that leaves the others' values as they are. Any NaN result is kNan.
//
// Polynomials are minimax, by Sollya's fpminimax (coefficients in binary32, binary64 where lanes
// are wide), in Horner's scheme. Reductions: Cody and Waite 1980; Payne and Hanek 1983.
//
// Included in kernel files.

inline constexpr float kNan = std::bit_cast<float>(0x7FC00000u);
inline constexpr float kInfinity = std::bit_cast<float>(0x7F800000u);

SOFTFOCUS_INLINE Bits sign_of(Floats v) { return as_bits(v) & 0x80000000u; }
SOFTFOCUS_INLINE Floats flip(Floats v, Bits sign) { return as_floats(as_bits(v) ^ sign); }
SOFTFOCUS_INLINE Floats nan_unless(Mask mask, Floats v) { return select(mask, v, splat(kNan)); }

/// c0 + x (c1 + x (c2 + ...)).
template <class Vector, class Number>
SOFTFOCUS_INLINE Vector polynomial(Vector x, Number c0, Number c1) {
  return c0 + x * c1;
}
template <class Vector, class Number, class... More>
SOFTFOCUS_INLINE Vector polynomial(Vector x, Number c0, Number c1, More... more) {
  return c0 + x * polynomial(x, c1, more...);
}

// --- binary64: the lanes of a vector of floats in two vectors ---

using Doubles [[gnu::vector_size(4 * SOFTFOCUS_LANES)]] = double;
struct Wide {
  Doubles low, high;
};

using HalfOfFloats [[gnu::vector_size(2 * SOFTFOCUS_LANES)]] = float;
// g++ 12 converts AVX's vectors in pieces, through memory, unless asked by an intrinsic.
SOFTFOCUS_INLINE Doubles to_doubles(HalfOfFloats v) {
#if SOFTFOCUS_LANES == 16
  return (Doubles)_mm512_maskz_cvtps_pd(0xFF, (__m256)v);
#elif SOFTFOCUS_LANES == 8
  return (Doubles)_mm256_cvtps_pd((__m128)v);
#else
  return __builtin_convertvector(v, Doubles);
#endif
}
SOFTFOCUS_INLINE HalfOfFloats to_half_of_floats(Doubles v) {
#if SOFTFOCUS_LANES == 16
  return (HalfOfFloats)_mm512_maskz_cvtpd_ps(0xFF, (__m512d)v);
#elif SOFTFOCUS_LANES == 8
  return (HalfOfFloats)_mm256_cvtpd_ps((__m256d)v);
#else
  return __builtin_convertvector(v, HalfOfFloats);
#endif
}

template <std::size_t... lane>
SOFTFOCUS_INLINE Wide widen_lanes(Floats v, std::index_sequence<lane...>) {
  return {to_doubles(__builtin_shufflevector(v, v, lane...)),
          to_doubles(__builtin_shufflevector(v, v, (lane + kLanes / 2)...))};
}
SOFTFOCUS_INLINE Wide widen(Floats v) {
  return widen_lanes(v, std::make_index_sequence<kLanes / 2>{});
}
template <std::size_t... lane>
SOFTFOCUS_INLINE Floats join_lanes_of(HalfOfFloats low, HalfOfFloats high,
                                      std::index_sequence<lane...>) {
  return __builtin_shufflevector(low, high, lane...);
}
SOFTFOCUS_INLINE Floats narrow(const Wide& v) {
  return join_lanes_of(to_half_of_floats(v.low), to_half_of_floats(v.high),
                       std::make_index_sequence<kLanes>{});
}

/// A number below 2^22 plus this is rounded to a whole one, ties to even, whose low bits are the
/// sum's.
inline constexpr float kWhole = 0x1.8p23f;
inline constexpr double kWholeDouble = 0x1.8p52;  ///< likewise, below 2^51

template <std::size_t... lane>
SOFTFOCUS_INLINE Bits low_words(Doubles low, Doubles high, std::index_sequence<lane...>) {
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
  return __builtin_shufflevector((Bits)low, (Bits)high, (2 * lane + 1)...);
#else
  return __builtin_shufflevector((Bits)low, (Bits)high, (2 * lane)...);
#endif
}
SOFTFOCUS_INLINE Bits low_words(Doubles low, Doubles high) {
  return low_words(low, high, std::make_index_sequence<kLanes>{});
}

SOFTFOCUS_INLINE Doubles square_root(Doubles v) {
#if SOFTFOCUS_LANES == 16
  return (Doubles)_mm512_maskz_sqrt_pd(0xFF, (__m512d)v);
#elif SOFTFOCUS_LANES == 8
  return (Doubles)_mm256_sqrt_pd((__m256d)v);
#elif defined(__SSE2__)
  return (Doubles)_mm_sqrt_pd((__m128d)v);
#elif defined(__wasm_simd128__)
  return (Doubles)wasm_f64x2_sqrt((v128_t)v);
#else
  return Doubles{std::sqrt(v[0]), std::sqrt(v[1])};
#endif
}

// --- powers and logarithms ---

/// v 2^n, for v from 1/2 to 2 and n from -152 to 130 in the low bits; one rounding.
SOFTFOCUS_INLINE Floats times_power_of_two(Floats v, Bits n) {
  const Bits half = (n << 22) & 0xFF800000u;
  const Bits rest = (n << 23) - half;
  return as_floats(as_bits(v) + half) * as_floats(rest + 0x3F800000u);
}

/// 2^x for |x| <= 1/2.
SOFTFOCUS_INLINE Floats power_of_fraction(Floats x) {
  return polynomial(x, 1.0f, 0x1.62e43p-1f, 0x1.ebfbd8p-3f, 0x1.c6af74p-5f, 0x1.3b3096p-7f,
                    0x1.5f0ca8p-10f, 0x1.3fad5ep-13f);
}

SOFTFOCUS_INLINE Floats binary_exponential(Floats x) {
  const Floats limited = smaller(larger(x, splat(-151.0f)), splat(129.0f));
  const Floats shifted = limited + kWhole;
  const Floats value = power_of_fraction(limited - (shifted - kWhole));
  return nan_unless(x == x, times_power_of_two(value, as_bits(shifted)));
}

inline constexpr float kLn2High = 355.0f / 512.0f;  // ln 2 = high + low; few bits: n high is exact
inline constexpr float kLn2Low = -0x1.bd0106p-13f;

/// e^x 2^more. Of NaN it is any number.
SOFTFOCUS_INLINE Floats scaled_exponential(Floats x, std::uint32_t more) {
  const Floats limited = smaller(larger(x, splat(-105.0f)), splat(90.0f));
  const Floats shifted = limited * 0x1.715476p+0f + kWhole;
  const Floats n = shifted - kWhole;
  const Floats rest = (limited - n * kLn2High) - n * kLn2Low;
  const Floats tail = polynomial(rest, 0x1.fffffap-2f, 0x1.555492p-3f, 0x1.555a26p-5f,
                                 0x1.123986p-7f, 0x1.694ccep-10f);
  const Floats value = 1.0f + (rest + rest * rest * tail);
  return times_power_of_two(value, as_bits(shifted) + more);
}
SOFTFOCUS_INLINE Floats exponential(Floats x) {
  return nan_unless(x == x, scaled_exponential(x, 0));
}

/// Zero, subnormal, negative, infinite or NaN, by one comparison.
SOFTFOCUS_INLINE Mask not_positive_normal(Floats v) {
  return as_ints(as_bits(v) + 0x7F800000u) >= -0x01000000;
}

/// 2^exponent mantissa, with the mantissa in [sqrt 1/2, sqrt 2).
struct Parts {
  Ints exponent;
  Floats mantissa;
};
/// Of a positive normal number.
SOFTFOCUS_INLINE Parts split(Floats v) {
  const Bits from_root = as_bits(v) - 0x3F3504F3u;  // sqrt 1/2
  return {as_ints(from_root) >> 23, as_floats((from_root & 0x007FFFFFu) + 0x3F3504F3u)};
}

/// A positive number's parts, if subnormals are among them.
SOFTFOCUS_INLINE Parts split_any(Floats v) {
  const Mask small = v < 0x1p-126f;
  Parts parts = split(select(small, v * 0x1p23f, v));
  parts.exponent -= small & 23;
  return parts;
}

/// A logarithm, with what those of special values are.
SOFTFOCUS_INLINE Floats special_logarithms(Floats x, Floats logarithm) {
  const Floats positive = select(x < kInfinity, logarithm, x);
  const Floats other = select(x == 0.0f, splat(-kInfinity), splat(kNan));
  return select(x > 0.0f, positive, other);
}

SOFTFOCUS_INLINE Floats binary_logarithm(Floats x) {
  const bool special = any(not_positive_normal(x));
  const Parts parts = special ? split_any(x) : split(x);
  const Floats t = parts.mantissa - 1.0f;
  // log2(1 + t) = t + t (...), for the sake of the last bits.
  const Floats tail =
      polynomial(t, 0x1.c551dap-2f, -0x1.71547p-1f, 0x1.ec7028p-2f, -0x1.715a94p-2f, 0x1.278fe4p-2f,
                 -0x1.ead2p-3f, 0x1.a0f066p-3f, -0x1.84bef2p-3f, 0x1.87ce3ap-3f, -0x1.e5db3cp-4f);
  const Floats value = to_floats(parts.exponent) + (t + t * tail);
  return special ? special_logarithms(x, value) : value;
}

SOFTFOCUS_INLINE Floats logarithm(Floats x) {
  const bool special = any(not_positive_normal(x));
  const Parts parts = special ? split_any(x) : split(x);
  const Floats t = parts.mantissa - 1.0f;
  const Floats tail =
      polynomial(t, -0x1.fffff8p-2f, 0x1.555544p-2f, -0x1.00042ap-2f, 0x1.99a9d2p-3f,
                 -0x1.542c02p-3f, 0x1.220762p-3f, -0x1.0ea664p-3f, 0x1.0a9af8p-3f, -0x1.407e5ep-4f);
  const Floats exponent = to_floats(parts.exponent);
  const Floats value = (t + (t * t * tail + exponent * kLn2Low)) + exponent * kLn2High;
  return special ? special_logarithms(x, value) : value;
}

/// log2 of numbers from sqrt 1/2 to sqrt 2, relative error below 2^-37: log2((1 + s) / (1 - s)).
SOFTFOCUS_INLINE Doubles wide_logarithm(Doubles mantissa) {
  const Doubles s = (mantissa - 1.0) / (mantissa + 1.0);
  return s * polynomial(s * s, 0x1.71547652bedf1p1, 0x1.ec709d12d1d7ap-1, 0x1.27777fe6aa749p-1,
                        0x1.a58d89b135d6cp-2, 0x1.5ce8430909217p-2);
}

SOFTFOCUS_INLINE Doubles within_thousand(Doubles v) {
  v = v < 1000.0 ? v : Doubles{} + 1000.0;
  return v > -1000.0 ? v : Doubles{} - 1000.0;
}

SOFTFOCUS_INLINE Floats power(Floats x, Floats y) {
  const bool special = any(not_positive_normal(x) | (as_ints(absolute(y)) >= 0x4B000000));  // 2^23
  const Parts parts = special ? split_any(x) : split(x);
  const Wide mantissa = widen(parts.mantissa);
  Wide exponent = widen(to_floats(parts.exponent));
  Floats factor = y;
  if (special) {
    // 0 and infinity count as powers of two that any y but 0 takes out of range.
    const Floats finite = select(x < kInfinity, to_floats(parts.exponent), splat(0x1p120f));
    exponent = widen(select(x == 0.0f, splat(-0x1p120f), finite));
    const Floats large = smaller(larger(y, splat(-0x1p127f)), splat(0x1p127f));
    const Mask tiny = (y != 0.0f) & (absolute(y) < 0x1p-60f);
    factor = select(tiny, flip(splat(0x1p-60f), sign_of(y)), large);
  }
  const Wide wide_factor = widen(factor);
  Doubles low = wide_factor.low * (exponent.low + wide_logarithm(mantissa.low));
  Doubles high = wide_factor.high * (exponent.high + wide_logarithm(mantissa.high));
  if (special) {
    low = within_thousand(low);
    high = within_thousand(high);
  }
  const Doubles shifted_low = low + kWholeDouble;
  const Doubles shifted_high = high + kWholeDouble;
  const Floats fraction =
      narrow({low - (shifted_low - kWholeDouble), high - (shifted_high - kWholeDouble)});
  const Ints n = as_ints(low_words(shifted_low, shifted_high));
  const Bits limited = as_bits(smaller(larger(n, splat(-151)), splat(129)));
  const Floats value = times_power_of_two(power_of_fraction(fraction), limited);
  return special ? nan_unless((x >= 0.0f) & (y == y), value) : value;
}

SOFTFOCUS_INLINE Floats inverse_square_root(Floats x) {
  return nan_unless(x >= 0.0f, 1.0f / square_root(x));
}

// --- angles ---

/// How an angle is cut: x = (step count + offset) pi/2 + rest. Half turns for sine and cosine: one
/// polynomial up to pi/2 takes three quarters of the time that two up to pi/4 take.
struct Cut {
  int step, offset;
};
inline constexpr Cut kSineCut{2, 0};
inline constexpr Cut kCosineCut{2, 1};
inline constexpr Cut kTangentCut{1, 0};

struct Angle {
  Floats rest;
  Bits count;  ///< the low bits
};

/// Angles are reduced in binary32, from here on in binary64, and in integers.
inline constexpr float kFarAngle = 6432.0f;
inline constexpr float kHugeAngle = 0x1p24f;

struct HugeAngle {
  float rest;
  std::uint32_t count;
};
/// Angles from kHugeAngle on, by a product with the digits of 1 / (2 pi).
inline HugeAngle reduce_huge_angle(std::uint32_t bits, Cut cut) {
  static constexpr std::uint32_t kTurnsPerRadian[]{0x28BE60DB, 0x9391054A, 0x7F09D5F4, 0x7D4D3770,
                                                   0x36D8A566, 0x4F10E410, 0x7F9458EA};
  const std::uint32_t exponent = (bits >> 23) - 150;
  const std::uint64_t mantissa = (bits & 0x007FFFFFu) | 0x00800000u;
  // Digits that make whole turns are left out.
  std::uint64_t digits[3];
  for (std::uint32_t i = 0; i < 3; ++i) {
    const std::uint64_t upper = kTurnsPerRadian[exponent / 32 + i];
    const std::uint64_t lower = kTurnsPerRadian[exponent / 32 + i + 1];
    digits[i] = (upper << 32 | lower) >> (32 - exponent % 32) & 0xFFFFFFFFu;
  }
  constexpr int kQuarter = 62;  // 2^64 is a turn
  const std::uint64_t turn = (mantissa * digits[0] << 32) + mantissa * digits[1] +
                             (mantissa * digits[2] >> 32) -
                             (static_cast<std::uint64_t>(cut.offset) << kQuarter);
  const int step = cut.step == 2 ? kQuarter + 1 : kQuarter;
  const std::uint64_t count = (turn + (std::uint64_t{1} << (step - 1))) >> step;
  const auto rest = static_cast<std::int64_t>(turn - (count << step));
  return {static_cast<float>(static_cast<double>(rest) * 0x1.921fb54442d18p-62),
          static_cast<std::uint32_t>(count)};
}

SOFTFOCUS_INLINE Doubles far_rest(Doubles x, Cut cut, Doubles& shifted) {
  const double whole = kWholeDouble * cut.step;
  shifted = (x * 0x1.45f306dc9c883p-1 - cut.offset) + whole;
  const Doubles quarters = (shifted - whole) + cut.offset;
  return (x - quarters * 0x1.921fb54p+0) - quarters * 0x1.10b4611a62633p-30;
}

[[gnu::noinline]] inline void reduce_far_angles(const Floats& x, Cut cut, Angle& angle) {
  const Wide wide = widen(x);
  Wide shifted;
  const Floats rest =
      narrow({far_rest(wide.low, cut, shifted.low), far_rest(wide.high, cut, shifted.high)});
  const Mask far = x >= kFarAngle;
  angle.rest = select(far, rest, angle.rest);
  angle.count = select(far, low_words(shifted.low, shifted.high), angle.count);
  for (int i = 0; i < kLanes; ++i) {
    if (!(x[i] >= kHugeAngle && x[i] < kInfinity)) continue;
    const HugeAngle huge = reduce_huge_angle(as_bits(x)[i], cut);
    angle.rest[i] = huge.rest;
    angle.count[i] = huge.count;
  }
}

/// Is one far or NaN? Needs x >= 0 or NaN.
SOFTFOCUS_INLINE bool any_far(Floats x) {
  constexpr auto kFar = std::bit_cast<std::int32_t>(kFarAngle);
  return any(as_ints(x) >= kFar);
}

SOFTFOCUS_INLINE Angle reduce_angle(Floats x, Cut cut, bool far) {
  const float whole = kWhole * static_cast<float>(cut.step);
  const auto offset = static_cast<float>(cut.offset);
  const Floats shifted = (x * 0x1.45f306p-1f - offset) + whole;
  Floats n = shifted - whole;
  if (cut.offset != 0) n += offset;
  // pi/2 in four parts. Products with the first three are exact, and so are the first two sums. The
  // third's error joins the fourth part, so that the rest is rounded once.
  const Floats coarse = (x - n * 0x1.922p+0f) + n * 0x1.28p-18f;
  const Floats third = n * 0x1.778p-25f;
  const Floats sum = coarse + third;
  const Floats error = (coarse - sum) + third;
  Angle angle = {sum + (error - n * 0x1.68c234p-39f), as_bits(shifted)};
  if (far) reduce_far_angles(x, cut, angle);
  return angle;
}

/// For |x| <= pi/2.
SOFTFOCUS_INLINE Floats sine_of_rest(Floats x) {
  const Floats square = x * x;
  return x + x * (square * polynomial(square, -0x1.55554cp-3f, 0x1.110edap-7f, -0x1.9f70e8p-13f,
                                      0x1.5dc80cp-19f));
}

SOFTFOCUS_INLINE Floats sine(Floats x) {
  const Floats size = absolute(x);
  const bool far = any_far(size);
  const Angle angle = reduce_angle(size, kSineCut, far);
  const Floats value = flip(sine_of_rest(angle.rest), (angle.count << 31) ^ sign_of(x));
  return far ? nan_unless(size < kInfinity, value) : value;
}

SOFTFOCUS_INLINE Floats cosine(Floats x) {
  const Floats size = absolute(x);
  const bool far = any_far(size);
  const Angle angle = reduce_angle(size, kCosineCut, far);
  const Floats value = flip(sine_of_rest(angle.rest), (angle.count + 1u) << 31);
  return far ? nan_unless(size < kInfinity, value) : value;
}

SOFTFOCUS_INLINE Floats tangent(Floats x) {
  const Floats size = absolute(x);
  const bool far = any_far(size);
  const Angle angle = reduce_angle(size, kTangentCut, far);
  const Floats square = angle.rest * angle.rest;
  const Floats of_rest =
      angle.rest +
      angle.rest * (square * polynomial(square, 0x1.5554dcp-2f, 0x1.112e48p-3f, 0x1.b57998p-5f,
                                        0x1.90c246p-6f, 0x1.929a74p-9f, 0x1.347a42p-7f));
  const Mask odd = as_ints(angle.count << 31) < 0;
  const Floats value = flip(select(odd, -1.0f / of_rest, of_rest), sign_of(x));
  return far ? nan_unless(size < kInfinity, value) : value;
}

inline constexpr float kHalfPi = 0x1.921fb6p+0f;
inline constexpr float kHalfPiRest = -0x1.777a5cp-25f;  ///< what pi/2 has beyond kHalfPi

/// arcsin x up to 1/2; beyond, arcsin of sqrt((1 - x) / 2), of which arccos x is twice.
struct Arc {
  Floats value;
  Mask beyond;
};
SOFTFOCUS_INLINE Arc arc_of(Floats x) {
  const Mask beyond = x > 0.5f;
  const Floats square = select(beyond, 0.5f - 0.5f * x, x * x);
  const Floats root = select(beyond, square_root(square), x);
  return {root + root * (square * polynomial(square, 0x1.5555c8p-3f, 0x1.330206p-4f, 0x1.747b72p-5f,
                                             0x1.8c415ap-6f, 0x1.5959aap-5f)),
          beyond};
}

SOFTFOCUS_INLINE Floats arcsine(Floats x) {
  const Arc arc = arc_of(absolute(x));
  const Floats complement = kHalfPi - (2.0f * arc.value - kHalfPiRest);
  const Floats value = flip(select(arc.beyond, complement, arc.value), sign_of(x));
  return nan_unless(absolute(x) <= 1.0f, value);
}

SOFTFOCUS_INLINE Floats arccosine(Floats x) {
  const Arc arc = arc_of(absolute(x));
  const Floats inner = kHalfPi - (flip(arc.value, sign_of(x)) - kHalfPiRest);
  const Floats twice = 2.0f * arc.value;
  const Floats obtuse = 2.0f * kHalfPi - (twice - 2.0f * kHalfPiRest);
  const Floats outer = select(x < 0.0f, obtuse, twice);
  return nan_unless(absolute(x) <= 1.0f, select(arc.beyond, outer, inner));
}

/// count pi/4 + arctan(quotient), this with the sign. Needs |quotient| <= tan(pi/8).
SOFTFOCUS_INLINE Floats arctangent_beside(Floats count, Floats quotient, Bits sign) {
  const Floats square = quotient * quotient;
  const Floats value =
      quotient + quotient * (square * polynomial(square, -0x1.555454p-2f, 0x1.9924dap-3f,
                                                 -0x1.1c3808p-3f, 0x1.49e716p-4f));
  // pi/4 in two parts. Products with the first are exact.
  return count * 0x1.921fbp-1f + (flip(value, sign) + count * 0x1.51110cp-23f);
}

SOFTFOCUS_INLINE Floats arctangent(Floats x) {
  // arctan x = pi/2 - arctan 1/x = pi/4 + arctan((x - 1) / (x + 1))
  const Floats size = absolute(x);
  const Mask over = size > 0x1.3504f4p+1f;    // tan(3 pi/8)
  const Mask middle = size > 0x1.a8279ap-2f;  // tan(pi/8)
  const Floats numerator = select(over, splat(-1.0f), select(middle, size - 1.0f, size));
  const Floats denominator = select(over, size, select(middle, size + 1.0f, splat(1.0f)));
  const Floats count = select(over, splat(2.0f), select(middle, splat(1.0f), splat(0.0f)));
  const Floats value = arctangent_beside(count, numerator / denominator, Bits{});
  return nan_unless(x == x, flip(value, sign_of(x)));
}

SOFTFOCUS_INLINE Floats arctangent(Floats y, Floats x) {
  const Floats height = absolute(y);
  const Floats width = absolute(x);
  Floats lesser = smaller(height, width);
  Floats greater = larger(height, width);
  const Mask huge = greater >= 0x1p126f;
  const Mask tiny = greater < 0x1p-100f;
  if (any(huge | tiny)) {
    // The sum below must not overflow, the comparison not be among subnormals. Infinity over
    // infinity counts as 1.
    const Floats scale = select(huge, splat(0x1p-30f), select(tiny, splat(0x1p60f), splat(1.0f)));
    const Mask infinite = lesser == kInfinity;
    lesser = select(infinite, splat(1.0f), lesser * scale);
    greater = select(infinite, splat(1.0f), greater * scale);
  }
  const Mask middle = lesser > greater * 0x1.a8279ap-2f;
  const Floats numerator = select(middle, lesser - greater, lesser);
  const Floats denominator = larger(select(middle, lesser + greater, greater), splat(0x1p-149f));
  const Floats eighths = select(middle, splat(1.0f), splat(0.0f));
  // Mirrored at the diagonal, then at the y axis.
  const Mask steep = height > width;
  const Mask behind = x < 0.0f;
  const Floats upright = select(steep, 2.0f - eighths, eighths);
  const Floats count = select(behind, 4.0f - upright, upright);
  const Bits mirrored = as_bits(steep ^ behind) & 0x80000000u;
  const Floats value = arctangent_beside(count, numerator / denominator, mirrored);
  return nan_unless((x == x) & (y == y), flip(value, sign_of(y)));
}

// --- hyperbolic functions ---

SOFTFOCUS_INLINE Floats hyperbolic_sine(Floats x) {
  const Floats size = absolute(x);
  const Floats half = scaled_exponential(size, 0xFFFFFFFFu);
  const Floats square = x * x;
  const Floats small = size + size * (square * polynomial(square, 0x1.555556p-3f, 0x1.1110eap-7f,
                                                          0x1.a01c22p-13f, 0x1.76771ep-19f));
  const Floats value = select(size < 1.0f, small, half - 0.25f / half);
  return nan_unless(x == x, flip(value, sign_of(x)));
}

SOFTFOCUS_INLINE Floats hyperbolic_cosine(Floats x) {
  const Floats half = scaled_exponential(absolute(x), 0xFFFFFFFFu);
  return nan_unless(x == x, half + 0.25f / half);
}

SOFTFOCUS_INLINE Floats hyperbolic_tangent(Floats x) {
  const Floats size = absolute(x);
  const Floats square = x * x;
  const Floats small =
      size + size * (square * polynomial(square, -0x1.555532p-2f, 0x1.110704p-3f, -0x1.b838ap-5f,
                                         0x1.5211c4p-6f, -0x1.758facp-8f));
  const Floats large = 1.0f - 2.0f / (scaled_exponential(2.0f * size, 0) + 1.0f);
  return nan_unless(x == x, flip(select(size < 0.625f, small, large), sign_of(x)));
}

/// scale log2 of numbers from 1 to 2^129.
SOFTFOCUS_INLINE Floats logarithm_of_wide(Doubles low, Doubles high, double scale) {
  // An eighth, so that its power of two and that one's inverse are normal floats.
  const Wide eighth = {low * 0.125, high * 0.125};
  const Parts parts = split(narrow(eighth));
  const Wide exponent = widen(to_floats(parts.exponent + 3));
  const Wide inverse = widen(as_floats(0x3F800000u - (as_bits(parts.exponent) << 23)));
  return narrow({scale * (exponent.low + wide_logarithm(eighth.low * inverse.low)),
                 scale * (exponent.high + wide_logarithm(eighth.high * inverse.high))});
}
inline constexpr double kLn2 = 0x1.62e42fefa39efp-1;
/// Below, a function that begins with x + x^3 / 6 or x^3 / 3 counts as x.
inline constexpr float kLinear = 0x1p-13f;

SOFTFOCUS_INLINE Floats inverse_hyperbolic_sine(Floats x) {
  const Floats size = absolute(x);
  const Wide wide = widen(size);
  const Floats value =
      logarithm_of_wide(wide.low + square_root(wide.low * wide.low + 1.0),
                        wide.high + square_root(wide.high * wide.high + 1.0), kLn2);
  const Mask curved = (size >= kLinear) & (size < kInfinity);
  return nan_unless(x == x, flip(select(curved, value, size), sign_of(x)));
}

SOFTFOCUS_INLINE Floats inverse_hyperbolic_cosine(Floats x) {
  const Wide wide = widen(x);
  const Floats value =
      logarithm_of_wide(wide.low + square_root((wide.low - 1.0) * (wide.low + 1.0)),
                        wide.high + square_root((wide.high - 1.0) * (wide.high + 1.0)), kLn2);
  return nan_unless(x >= 1.0f, select(x < kInfinity, value, x));
}

SOFTFOCUS_INLINE Floats inverse_hyperbolic_tangent(Floats x) {
  const Floats size = absolute(x);
  const Wide wide = widen(size);
  const Floats value = logarithm_of_wide((1.0 + wide.low) / (1.0 - wide.low),
                                         (1.0 + wide.high) / (1.0 - wide.high), kLn2 / 2);
  const Floats inside = select(size < kLinear, size, value);
  const Floats magnitude = select(size < 1.0f, inside, splat(kInfinity));
  return nan_unless(size <= 1.0f, flip(magnitude, sign_of(x)));
}

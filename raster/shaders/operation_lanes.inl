// What each operation makes of the bits of its operands, lane by lane: the definition of a shader's
// arithmetic (docs/specification.md). Constants are folded, and values that do not vary computed,
// by the same functions.
//
// Included in kernel files, after math_lanes.inl.

namespace {

// A number of each lane by a function of single numbers.
template <class Number, class Function>
SOFTFOCUS_INLINE Bits by_lane(Bits a, Bits b, Function function) {
  Number of_a[kLanes], of_b[kLanes], made[kLanes];
  std::memcpy(of_a, &a, sizeof a);
  std::memcpy(of_b, &b, sizeof b);
  for (int i = 0; i < kLanes; ++i) made[i] = function(of_a[i], of_b[i]);
  Bits v;
  std::memcpy(&v, made, sizeof v);
  return v;
}

/// The integer part, of any float.
SOFTFOCUS_INLINE Floats whole_part(Floats v) {
  const Bits sign = as_bits(v) & 0x80000000u;
  const Floats below = floor(absolute(v));
  return as_floats(as_bits(below) | sign);
}

/// Bits `first` to `first + count - 1`, in the low bits; count 0 gives 0, and what lies beyond the
/// 32nd bit is 0.
SOFTFOCUS_INLINE Bits field(Bits v, Bits first, Bits count) {
  const Bits moved = select((Mask)(first < 32u), v >> (first & 31u), splat(0u));
  const Bits ones = select((Mask)(count < 32u), (splat(1u) << (count & 31u)) - 1u, splat(~0u));
  return moved & ones;
}
SOFTFOCUS_INLINE Bits signed_field(Bits v, Bits first, Bits count) {
  const Bits low = field(v, first, count);
  const Bits sign =
      select((Mask)((count > 0u) & (count < 32u)), splat(1u) << ((count - 1u) & 31u), splat(0u));
  return (low ^ sign) - sign;
}

SOFTFOCUS_INLINE Bits bit_count(Bits v) {
  v = v - (v >> 1 & 0x55555555u);
  v = (v & 0x33333333u) + (v >> 2 & 0x33333333u);
  v = (v + (v >> 4)) & 0x0F0F0F0Fu;
  return v * 0x01010101u >> 24;
}
SOFTFOCUS_INLINE Bits reversed(Bits v) {
  v = (v >> 1 & 0x55555555u) | (v & 0x55555555u) << 1;
  v = (v >> 2 & 0x33333333u) | (v & 0x33333333u) << 2;
  v = (v >> 4 & 0x0F0F0F0Fu) | (v & 0x0F0F0F0Fu) << 4;
  v = (v >> 8 & 0x00FF00FFu) | (v & 0x00FF00FFu) << 8;
  return v >> 16 | v << 16;
}
/// The number of the highest bit that is set; -1 if none is.
SOFTFOCUS_INLINE Bits highest_bit(Bits v) {
  v |= v >> 1;
  v |= v >> 2;
  v |= v >> 4;
  v |= v >> 8;
  v |= v >> 16;
  return bit_count(v) - 1u;
}

// Division by 0 gives all bits; the least number divided by -1 is itself, and leaves 0.
struct DivideUnsigned {
  std::uint32_t operator()(std::uint32_t a, std::uint32_t b) const { return b == 0 ? ~0u : a / b; }
};
struct ModuloUnsigned {
  std::uint32_t operator()(std::uint32_t a, std::uint32_t b) const { return b == 0 ? ~0u : a % b; }
};
struct DivideSigned {
  std::int32_t operator()(std::int32_t a, std::int32_t b) const {
    if (b == 0) return -1;
    return b == -1 ? static_cast<std::int32_t>(0u - static_cast<std::uint32_t>(a)) : a / b;
  }
};
struct RemainderSigned {
  std::int32_t operator()(std::int32_t a, std::int32_t b) const {
    if (b == 0) return -1;
    return b == -1 ? 0 : a % b;
  }
};
struct ModuloSigned {
  std::int32_t operator()(std::int32_t a, std::int32_t b) const {
    const std::int32_t rest = RemainderSigned{}(a, b);
    return b != 0 && rest != 0 && (rest < 0) != (b < 0) ? rest + b : rest;
  }
};
struct HighUnsigned {
  std::uint32_t operator()(std::uint32_t a, std::uint32_t b) const {
    return static_cast<std::uint32_t>(std::uint64_t{a} * b >> 32);
  }
};
struct HighSigned {
  std::int32_t operator()(std::int32_t a, std::int32_t b) const {
    return static_cast<std::int32_t>(static_cast<std::uint64_t>(std::int64_t{a} * b) >> 32);
  }
};
/// x = mantissa 2^exponent with 1/2 <= |mantissa| < 1; 0, infinities and NaN are their own
/// mantissa, with exponent 0.
struct MantissaOf {
  template <class Number>
  Number operator()(Number x, Number) const {
    int exponent = 0;
    return x - x != Number{} ? x : std::frexp(x, &exponent);
  }
};
struct ExponentOf {
  template <class Number>
  std::int32_t operator()(Number x) const {
    int exponent = 0;
    if (x - x == Number{}) static_cast<void>(std::frexp(x, &exponent));
    return exponent;
  }
};
/// x 2^n, rounded once. Beyond `most` all numbers are 0 or infinite.
template <class Number>
Number scaled(Number x, std::int32_t n, std::int32_t most) {
  return std::ldexp(x, n < -most ? -most : n > most ? most : n);
}

/// Of operations that give a double, by that of the low word.
template <ShaderOp op>
double double_of(double x, double y, std::uint32_t a, std::uint32_t c) {
  using Op = ShaderOp;
  if constexpr (op == Op::add_doubles) return x + y;
  if constexpr (op == Op::subtract_doubles) return x - y;
  if constexpr (op == Op::multiply_doubles) return x * y;
  if constexpr (op == Op::divide_doubles) return x / y;
  if constexpr (op == Op::square_root_of_double) return std::sqrt(x);
  if constexpr (op == Op::floor_of_double) return std::floor(x);
  if constexpr (op == Op::round_even_double) return std::nearbyint(x);
  if constexpr (op == Op::mantissa_of_double) return MantissaOf{}(x, 0.0);
  if constexpr (op == Op::scale_double) return scaled(x, std::bit_cast<std::int32_t>(c), 2200);
  if constexpr (op == Op::double_of_float) return static_cast<double>(std::bit_cast<float>(a));
  return static_cast<double>(std::bit_cast<std::int32_t>(a));  // double_of_signed
}

/// Lane by lane: a and b are the words of x, c and d of y.
template <ShaderOp op>
SOFTFOCUS_INLINE Bits apply_to_doubles(Bits a, Bits b, Bits c, Bits d) {
  using Op = ShaderOp;
  std::uint32_t words[4][kLanes], made[kLanes];
  std::memcpy(words[0], &a, sizeof a);
  std::memcpy(words[1], &b, sizeof b);
  std::memcpy(words[2], &c, sizeof c);
  std::memcpy(words[3], &d, sizeof d);
  for (int i = 0; i < kLanes; ++i) {
    const auto x = std::bit_cast<double>(std::uint64_t{words[1][i]} << 32 | words[0][i]);
    const auto y = std::bit_cast<double>(std::uint64_t{words[3][i]} << 32 | words[2][i]);
    if constexpr (op < Op::float_of_double) {
      constexpr int kIsHigh = (static_cast<int>(op) - static_cast<int>(Op::add_doubles)) % 2;
      constexpr auto kLow = static_cast<Op>(static_cast<int>(op) - kIsHigh);
      const double value = double_of<kLow>(x, y, words[0][i], words[2][i]);
      made[i] = static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(value) >> (32 * kIsHigh));
    }
    if constexpr (op == Op::float_of_double) {
      made[i] = std::bit_cast<std::uint32_t>(static_cast<float>(x));
    }
    if constexpr (op == Op::signed_of_double) {
      made[i] = static_cast<std::uint32_t>(
          x > -2147483649.0 && x < 0x1p31 ? static_cast<std::int32_t>(x) : INT32_MIN);
    }
    if constexpr (op == Op::exponent_of_double) {
      made[i] = static_cast<std::uint32_t>(ExponentOf{}(x));
    }
    if constexpr (op == Op::equal_doubles) made[i] = x == y ? ~0u : 0u;
    if constexpr (op == Op::less_doubles) made[i] = x < y ? ~0u : 0u;
    if constexpr (op == Op::less_equal_doubles) made[i] = x <= y ? ~0u : 0u;
  }
  Bits v;
  std::memcpy(&v, made, sizeof v);
  return v;
}

template <ShaderOp op>
SOFTFOCUS_INLINE Bits apply(Bits a, Bits b, Bits c, [[maybe_unused]] Bits d) {
  using Op = ShaderOp;
  if constexpr (is_of_doubles(op)) return apply_to_doubles<op>(a, b, c, d);
  const Floats x = as_floats(a), y = as_floats(b);
  const Ints i = as_ints(a), j = as_ints(b);
  static_cast<void>(x), static_cast<void>(y), static_cast<void>(i), static_cast<void>(j);
  static_cast<void>(c);
  if constexpr (op == Op::add) return as_bits(x + y);
  if constexpr (op == Op::subtract) return as_bits(x - y);
  if constexpr (op == Op::multiply) return as_bits(x * y);
  if constexpr (op == Op::divide) return as_bits(x / y);
  if constexpr (op == Op::negate) return a ^ 0x80000000u;
  if constexpr (op == Op::absolute) return a & 0x7FFFFFFFu;
  if constexpr (op == Op::minimum) return as_bits(select(x == x, smaller(y, x), y));
  if constexpr (op == Op::maximum) return as_bits(select(x == x, select(x < y, y, x), y));
  if constexpr (op == Op::floor) return as_bits(floor(x));
  if constexpr (op == Op::ceiling) {
    return as_bits(floor(as_floats(a ^ 0x80000000u))) ^ 0x80000000u;
  }
  if constexpr (op == Op::truncate) return as_bits(whole_part(x));
  if constexpr (op == Op::round_even) return as_bits(nearest(x));
  if constexpr (op == Op::fraction) return as_bits(x - floor(x));
  if constexpr (op == Op::sign) {
    const Floats below = select(x < 0.0f, splat(-1.0f), splat(0.0f));
    return as_bits(select(x > 0.0f, splat(1.0f), below));
  }
  if constexpr (op == Op::square_root) return as_bits(square_root(x));
  if constexpr (op == Op::fused_multiply_add) {
    return as_bits(fused_multiply_add(x, y, as_floats(c)));
  }
  if constexpr (op == Op::remainder) return as_bits(x - y * whole_part(x / y));
  if constexpr (op == Op::modulo) return as_bits(x - y * floor(x / y));
  if constexpr (op == Op::inverse_square_root) return as_bits(inverse_square_root(x));
  if constexpr (op == Op::sine) return as_bits(sine(x));
  if constexpr (op == Op::cosine) return as_bits(cosine(x));
  if constexpr (op == Op::tangent) return as_bits(tangent(x));
  if constexpr (op == Op::arc_sine) return as_bits(arcsine(x));
  if constexpr (op == Op::arc_cosine) return as_bits(arccosine(x));
  if constexpr (op == Op::arc_tangent) return as_bits(arctangent(x));
  if constexpr (op == Op::arc_tangent_2) return as_bits(arctangent(x, y));
  if constexpr (op == Op::hyperbolic_sine) return as_bits(hyperbolic_sine(x));
  if constexpr (op == Op::hyperbolic_cosine) return as_bits(hyperbolic_cosine(x));
  if constexpr (op == Op::hyperbolic_tangent) return as_bits(hyperbolic_tangent(x));
  if constexpr (op == Op::area_sine) return as_bits(inverse_hyperbolic_sine(x));
  if constexpr (op == Op::area_cosine) return as_bits(inverse_hyperbolic_cosine(x));
  if constexpr (op == Op::area_tangent) return as_bits(inverse_hyperbolic_tangent(x));
  if constexpr (op == Op::exponential) return as_bits(exponential(x));
  if constexpr (op == Op::logarithm) return as_bits(logarithm(x));
  if constexpr (op == Op::exponential_2) return as_bits(binary_exponential(x));
  if constexpr (op == Op::logarithm_2) return as_bits(binary_logarithm(x));
  if constexpr (op == Op::power) return as_bits(power(x, y));
  if constexpr (op == Op::mantissa_of) return by_lane<float>(a, b, MantissaOf{});
  if constexpr (op == Op::scale_by_exponent || op == Op::exponent_of) {
    float of_x[kLanes];
    std::int32_t of_n[kLanes];
    std::memcpy(of_x, &a, sizeof a);
    std::memcpy(of_n, &b, sizeof b);
    for (int lane = 0; lane < kLanes; ++lane) {
      if constexpr (op == Op::exponent_of) of_n[lane] = ExponentOf{}(of_x[lane]);
      if constexpr (op == Op::scale_by_exponent) of_x[lane] = scaled(of_x[lane], of_n[lane], 400);
    }
    Bits made;
    std::memcpy(&made, op == Op::exponent_of ? static_cast<const void*>(of_n) : of_x, sizeof made);
    return made;
  }
  if constexpr (op == Op::add_integers) return a + b;
  if constexpr (op == Op::subtract_integers) return a - b;
  if constexpr (op == Op::multiply_integers) return a * b;
  if constexpr (op == Op::negate_integer) return 0u - a;
  if constexpr (op == Op::absolute_integer) return select((Mask)(i < 0), 0u - a, a);
  if constexpr (op == Op::sign_integer) return select((Mask)(i > 0), splat(1u), as_bits(i >> 31));
  if constexpr (op == Op::divide_unsigned) return by_lane<std::uint32_t>(a, b, DivideUnsigned{});
  if constexpr (op == Op::modulo_unsigned) return by_lane<std::uint32_t>(a, b, ModuloUnsigned{});
  if constexpr (op == Op::divide_signed) return by_lane<std::int32_t>(a, b, DivideSigned{});
  if constexpr (op == Op::remainder_signed) return by_lane<std::int32_t>(a, b, RemainderSigned{});
  if constexpr (op == Op::modulo_signed) return by_lane<std::int32_t>(a, b, ModuloSigned{});
  if constexpr (op == Op::multiply_high_unsigned) {
    return by_lane<std::uint32_t>(a, b, HighUnsigned{});
  }
  if constexpr (op == Op::multiply_high_signed) return by_lane<std::int32_t>(a, b, HighSigned{});
  if constexpr (op == Op::minimum_signed) return as_bits(smaller(i, j));
  if constexpr (op == Op::maximum_signed) return as_bits(larger(i, j));
  if constexpr (op == Op::minimum_unsigned) return select((Mask)(a < b), a, b);
  if constexpr (op == Op::maximum_unsigned) return select((Mask)(a > b), a, b);
  if constexpr (op == Op::shift_left) return a << (b & 31u);
  if constexpr (op == Op::shift_right) return a >> (b & 31u);
  if constexpr (op == Op::shift_right_signed) return as_bits(i >> as_ints(b & 31u));
  if constexpr (op == Op::bit_and) return a & b;
  if constexpr (op == Op::bit_or) return a | b;
  if constexpr (op == Op::bit_xor) return a ^ b;
  if constexpr (op == Op::bit_not) return ~a;
  if constexpr (op == Op::count_bits) return bit_count(a);
  if constexpr (op == Op::reverse_bits) return reversed(a);
  if constexpr (op == Op::lowest_bit) {
    return select((Mask)(a == 0u), splat(~0u), bit_count((a & (0u - a)) - 1u));
  }
  if constexpr (op == Op::highest_bit_unsigned) return highest_bit(a);
  if constexpr (op == Op::highest_bit_signed) return highest_bit(a ^ as_bits(i >> 31));
  if constexpr (op == Op::extract_bits_unsigned) return field(a, b, c);
  if constexpr (op == Op::extract_bits_signed) return signed_field(a, b, c);
  if constexpr (op == Op::equal) return as_bits((Mask)(x == y));
  if constexpr (op == Op::not_equal) return as_bits((Mask)(x != y));
  if constexpr (op == Op::less) return as_bits((Mask)(x < y));
  if constexpr (op == Op::less_equal) return as_bits((Mask)(x <= y));
  if constexpr (op == Op::equal_integers) return as_bits((Mask)(a == b));
  if constexpr (op == Op::less_signed) return as_bits((Mask)(i < j));
  if constexpr (op == Op::less_equal_signed) return as_bits((Mask)(i <= j));
  if constexpr (op == Op::less_unsigned) return as_bits((Mask)(a < b));
  if constexpr (op == Op::less_equal_unsigned) return as_bits((Mask)(a <= b));
  if constexpr (op == Op::is_infinite) {
    return as_bits((Mask)((a & 0x7FFFFFFFu) == 0x7F800000u));
  }
  if constexpr (op == Op::select) return select((Mask)as_ints(a), b, c);
  if constexpr (op == Op::to_signed) return as_bits(truncate_to_int(x));
  if constexpr (op == Op::to_unsigned) {
    const Bits upper = as_bits(truncate_to_int(x - 0x1p31f)) ^ 0x80000000u;
    return select((Mask)(x < 0x1p31f), as_bits(truncate_to_int(x)), upper);
  }
  if constexpr (op == Op::from_signed) return as_bits(to_floats(i));
  if constexpr (op == Op::from_unsigned) {
    // Exact halves, and one rounding.
    return as_bits(to_floats(as_ints(a >> 16)) * 65536.0f + to_floats(as_ints(a & 0xFFFFu)));
  }
  if constexpr (op == Op::to_half) return float_to_half<HalfRounding::nearest_even>(x);
  if constexpr (op == Op::from_half) return as_bits(half_to_float(a & 0xFFFFu));
  if constexpr (op == Op::copy) return a;
  return a;
}

}  // namespace

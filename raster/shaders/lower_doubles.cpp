// Operations on doubles, as operations on their words.

#include <limits>

#include "raster/shaders/lowering.h"

namespace softfocus {

ShaderValue Lowering::double_of(ShaderValue low, ShaderValue high) {
  doubles_.push_back({low, high});
  return kDouble | static_cast<ShaderValue>(doubles_.size() - 1);
}

ShaderValue Lowering::constant_like(ShaderValue of, float value) {
  if (!is_double(of)) return constant(value);
  const auto bits = std::bit_cast<std::uint64_t>(static_cast<double>(value));
  return double_of(whole(static_cast<std::uint32_t>(bits)),
                   whole(static_cast<std::uint32_t>(bits >> 32)));
}

Scalars Lowering::numbers(const Call& call, SpirvId id) {
  Scalars words = value(call, id);
  if (!module_.has_doubles || !holds_doubles(type_of(call, id))) return words;
  Scalars made;
  for (std::size_t i = 0; i + 1 < words.size(); i += 2) {
    made.push_back(double_of(words[i], words[i + 1]));
  }
  return made;
}

Scalars Lowering::words_of(const Scalars& numbers) const {
  Scalars words;
  words.reserve(numbers.size());
  for (const ShaderValue of : numbers) {
    if (!is_double(of)) {
      words.push_back(of);
      continue;
    }
    const DoubleWords& each = doubles_[of & ~kDouble];
    words.insert(words.end(), {each.low, each.high});
  }
  return words;
}

Scalars Lowering::bits_of_doubles(ShaderRegion& to, const Scalars& of) {
  Scalars made;
  for (const ShaderValue each : of) {
    if (!is_double(each)) damaged("a double is none");
    const auto [low, high] = doubles_[each & ~kDouble];
    const ShaderValue is_nan = make(to, ShaderOp::not_equal, each, each);
    made.push_back(make(to, ShaderOp::select, is_nan, whole(0), low));
    made.push_back(make(to, ShaderOp::select, is_nan, whole(0x7FF80000u), high));
  }
  return made;
}

ShaderValue Lowering::convert_to_double(ShaderRegion& to, ShaderOp from, ShaderValue a) {
  using enum ShaderOp;
  if (from == from_unsigned) {  // less 2^31, which is added again: exact
    const ShaderValue less = make(to, bit_xor, a, whole(0x80000000u));
    const ShaderValue moved = convert_to_double(to, from_signed, less);
    return make(to, add, moved, constant_like(moved, 0x1p31f));
  }
  const ShaderOp low = from == from_signed ? double_of_signed : double_of_float;
  const ShaderValue low_word = make(to, low, a);
  return double_of(low_word, make(to, static_cast<ShaderOp>(static_cast<int>(low) + 1), a));
}

ShaderValue Lowering::make_of_doubles(ShaderRegion& to, ShaderOp op, ShaderValue a, ShaderValue b,
                                      ShaderValue c) {
  using enum ShaderOp;
  const auto words = [&](ShaderValue of) {
    if (of == kNoValue) return DoubleWords{kNoValue, kNoValue};
    if (!is_double(of)) damaged("a double and another number are operands of one operation");
    return doubles_[of & ~kDouble];
  };
  if (op == select) {
    const DoubleWords yes = words(b), no = words(c);
    const ShaderValue low = make(to, select, a, yes.low, no.low);
    return double_of(low, make(to, select, a, yes.high, no.high));
  }
  const DoubleWords x = words(a), y = op == scale_by_exponent ? DoubleWords{b, kNoValue} : words(b);
  const auto one = [&](ShaderOp of) { return make(to, of, x.low, x.high, y.low, y.high); };
  const auto two = [&](ShaderOp low) {
    const ShaderValue low_word = one(low);
    return double_of(low_word, one(static_cast<ShaderOp>(static_cast<int>(low) + 1)));
  };
  const auto number = [&](float value) { return constant_like(a, value); };
  const auto choose = [&](ShaderValue is, ShaderValue yes, ShaderValue no) {
    return make(to, select, is, yes, no);
  };
  switch (op) {
    case add: return two(add_doubles);
    case subtract: return two(subtract_doubles);
    case multiply: return two(multiply_doubles);
    case divide: return two(divide_doubles);
    case negate: return double_of(x.low, make(to, bit_xor, x.high, whole(0x80000000u)));
    case absolute: return double_of(x.low, make(to, bit_and, x.high, whole(0x7FFFFFFFu)));
    case minimum:
    case maximum: {
      const ShaderValue is = op == minimum ? make(to, less, b, a) : make(to, less, a, b);
      return choose(make(to, equal, a, a), choose(is, b, a), b);
    }
    case floor: return two(floor_of_double);
    case ceiling: return make(to, negate, make(to, floor, make(to, negate, a)));
    case truncate: {
      const DoubleWords below = words(make(to, floor, make(to, absolute, a)));
      const ShaderValue sign = make(to, bit_and, x.high, whole(0x80000000u));
      return double_of(below.low, make(to, bit_or, below.high, sign));
    }
    case round_even: return two(round_even_double);
    case fraction: return make(to, subtract, a, make(to, floor, a));
    case sign: {
      const ShaderValue zero = number(0.0f);
      const ShaderValue below = choose(make(to, less, a, zero), number(-1.0f), zero);
      return choose(make(to, less, zero, a), number(1.0f), below);
    }
    case square_root: return two(square_root_of_double);
    case inverse_square_root: return make(to, divide, number(1.0f), make(to, square_root, a));
    case fused_multiply_add: return make(to, add, make(to, multiply, a, b), c);
    case remainder:
    case modulo: {
      const ShaderValue whole_part =
          make(to, op == modulo ? floor : truncate, make(to, divide, a, b));
      return make(to, subtract, a, make(to, multiply, b, whole_part));
    }
    case mantissa_of: return two(mantissa_of_double);
    case exponent_of: return one(exponent_of_double);
    case scale_by_exponent: return two(scale_double);
    case equal: return one(equal_doubles);
    case not_equal: return make(to, bit_not, one(equal_doubles));
    case less: return one(less_doubles);
    case less_equal: return one(less_equal_doubles);
    case is_infinite: {
      constexpr float kInfinity = std::numeric_limits<float>::infinity();
      return make(to, equal, make(to, absolute, a), number(kInfinity));
    }
    case to_signed: return one(signed_of_double);
    case to_unsigned: {
      const ShaderValue half = number(0x1p31f);
      const ShaderValue upper = make(to, to_signed, make(to, subtract, a, half));
      return choose(make(to, less, a, half), one(signed_of_double),
                    make(to, bit_xor, upper, whole(0x80000000u)));
    }
    case float_of_double: return one(op);
    default: refuse("this function of doubles is not supported; GLSL has none");
  }
}

}  // namespace softfocus

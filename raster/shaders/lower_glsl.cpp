// GLSL's built-in functions (the extended set GLSL.std.450) as scalar operations. The order of
// operations is the definition: docs/specification.md has it in words.

#include <numbers>

#include "raster/shaders/lowering.h"

namespace softfocus {
namespace {

/// A function of one operation.
ShaderOp plain_op(GlslOp op) {
  using enum GlslOp;
  using To = ShaderOp;
  switch (op) {
    case round:
    case round_even: return To::round_even;
    case trunc: return To::truncate;
    case float_abs: return To::absolute;
    case signed_abs: return To::absolute_integer;
    case float_sign: return To::sign;
    case signed_sign: return To::sign_integer;
    case floor: return To::floor;
    case ceil: return To::ceiling;
    case fract: return To::fraction;
    case sin: return To::sine;
    case cos: return To::cosine;
    case tan: return To::tangent;
    case asin: return To::arc_sine;
    case acos: return To::arc_cosine;
    case atan: return To::arc_tangent;
    case sinh: return To::hyperbolic_sine;
    case cosh: return To::hyperbolic_cosine;
    case tanh: return To::hyperbolic_tangent;
    case asinh: return To::area_sine;
    case acosh: return To::area_cosine;
    case atanh: return To::area_tangent;
    case atan2: return To::arc_tangent_2;
    case pow: return To::power;
    case exp: return To::exponential;
    case log: return To::logarithm;
    case exp2: return To::exponential_2;
    case log2: return To::logarithm_2;
    case sqrt: return To::square_root;
    case inverse_sqrt: return To::inverse_square_root;
    case float_min:
    case number_min: return To::minimum;
    case float_max:
    case number_max: return To::maximum;
    case unsigned_min: return To::minimum_unsigned;
    case signed_min: return To::minimum_signed;
    case unsigned_max: return To::maximum_unsigned;
    case signed_max: return To::maximum_signed;
    case fma: return To::fused_multiply_add;
    case ldexp: return To::scale_by_exponent;
    case find_lowest_bit: return To::lowest_bit;
    case find_signed_highest_bit: return To::highest_bit_signed;
    case find_unsigned_highest_bit: return To::highest_bit_unsigned;
    default: return To::copy;  // none
  }
}

std::size_t operands_of(GlslOp op) {
  using enum GlslOp;
  switch (op) {
    case float_clamp:
    case number_clamp:
    case unsigned_clamp:
    case signed_clamp:
    case float_mix:
    case smooth_step:
    case fma: return 3;
    case atan2:
    case pow:
    case float_min:
    case number_min:
    case float_max:
    case number_max:
    case unsigned_min:
    case signed_min:
    case unsigned_max:
    case signed_max:
    case step:
    case ldexp: return 2;
    default: return 1;
  }
}

}  // namespace

ShaderValue Lowering::glsl_scalar(GlslOp op, ShaderValue a, ShaderValue b, ShaderValue c,
                                  ShaderRegion& to) {
  using enum GlslOp;
  const auto multiply = [&](ShaderValue x, ShaderValue y) {
    return make(to, ShaderOp::multiply, x, y);
  };
  const auto subtract = [&](ShaderValue x, ShaderValue y) {
    return make(to, ShaderOp::subtract, x, y);
  };
  const auto clamp = [&](ShaderValue x, ShaderValue low, ShaderValue high) {
    return make(to, ShaderOp::minimum, make(to, ShaderOp::maximum, x, low), high);
  };
  const auto number = [&](float value) { return constant_like(a, value); };
  switch (op) {
    case radians: return multiply(a, constant(std::numbers::pi_v<float> / 180.0f));
    case degrees: return multiply(a, constant(180.0f / std::numbers::pi_v<float>));
    case float_clamp:
    case number_clamp: return clamp(a, b, c);
    case unsigned_clamp:
      return make(to, ShaderOp::minimum_unsigned, make(to, ShaderOp::maximum_unsigned, a, b), c);
    case signed_clamp:
      return make(to, ShaderOp::minimum_signed, make(to, ShaderOp::maximum_signed, a, b), c);
    case float_mix:  // a (1 - c) + b c
      return make(to, ShaderOp::add, multiply(a, subtract(number(1.0f), c)), multiply(b, c));
    case step:
      return make(to, ShaderOp::select, make(to, ShaderOp::less, b, a), number(0.0f), number(1.0f));
    case smooth_step: {  // t = clamp((c - a) / (b - a), 0, 1); (t t) (3 - 2 t)
      const ShaderValue t = clamp(make(to, ShaderOp::divide, subtract(c, a), subtract(b, a)),
                                  number(0.0f), number(1.0f));
      return multiply(multiply(t, t), subtract(number(3.0f), multiply(number(2.0f), t)));
    }
    default: return make(to, plain_op(op), a, b, c);
  }
}

Scalars Lowering::glsl_result(Call& call, const SpirvInstruction& in, ShaderRegion& to) {
  const Words& w = in.operands;
  if (word(w, 0) != module_.glsl || module_.glsl == 0) {
    refuse("an extended instruction set other than GLSL.std.450 is not supported");
  }
  const auto op = static_cast<GlslOp>(std::min(word(w, 1), 255u));
  using enum GlslOp;
  if (op == modf || op == frexp) return glsl_pointers(call, in, op, to);
  if (op == interpolate_at_centroid || op == interpolate_at_sample || op == interpolate_at_offset) {
    return this->load(to, place(call, word(w, 2)));  // a pixel has one sample, its middle
  }
  std::vector<Scalars> of;
  for (const SpirvId id : w.subspan(2)) of.push_back(numbers(call, id));
  if (of.empty() || of[0].empty()) damaged("a function has no operand");
  switch (op) {
    case determinant:
    case matrix_inverse: {
      const SpirvType& matrix = type(type_of(call, w[2]));
      if (matrix.kind != SpirvKind::matrix || matrix.count != type(matrix.element).count) {
        damaged("a matrix is not square");
      }
      if (op == determinant) return {this->determinant(of[0], matrix.count, to)};
      return inverse(of[0], matrix.count, to);
    }
    case modf_struct:
    case frexp_struct: {
      Scalars made, second;
      for (const ShaderValue x : of[0]) {
        const ShaderValue part = op == modf_struct ? make(to, ShaderOp::truncate, x)
                                                   : make(to, ShaderOp::exponent_of, x);
        made.push_back(op == modf_struct ? make(to, ShaderOp::subtract, x, part)
                                         : make(to, ShaderOp::mantissa_of, x));
        second.push_back(part);
      }
      made.insert(made.end(), second.begin(), second.end());
      return made;
    }
    case length:
    case distance:
    case cross:
    case normalize:
    case face_forward:
    case reflect:
    case refract: return glsl_vectors(op, of, to);
    case pack_double_2x32: return of[0];
    case unpack_double_2x32: return bits_of_doubles(to, of[0]);
    default: break;
  }
  if (op >= pack_snorm_4x8 && op <= unpack_unorm_4x8) return glsl_packs(op, of[0], to);
  if (of.size() < operands_of(op)) damaged("a function has too few operands");
  Scalars made;
  for (std::size_t i = 0; i < of[0].size(); ++i) {
    const auto operand = [&](std::size_t number) {
      if (number >= of.size()) return kNoValue;
      if (of[number].size() != of[0].size()) damaged("operands have two sizes");
      return of[number][i];
    };
    const bool is_known = plain_op(op) != ShaderOp::copy || op == radians || op == degrees ||
                          op == float_clamp || op == number_min || op == number_max ||
                          op == number_clamp || op == unsigned_clamp || op == signed_clamp ||
                          op == float_mix || op == step || op == smooth_step;
    if (!is_known) refuse("function " + std::to_string(static_cast<int>(op)) + " is not supported");
    made.push_back(glsl_scalar(op, operand(0), operand(1), operand(2), to));
  }
  return made;
}

Scalars Lowering::glsl_pointers(Call& call, const SpirvInstruction& in, GlslOp op,
                                ShaderRegion& to) {
  const Scalars all = numbers(call, word(in.operands, 2));
  Scalars made, second;
  for (const ShaderValue x : all) {
    if (op == GlslOp::modf) {
      second.push_back(make(to, ShaderOp::truncate, x));
      made.push_back(make(to, ShaderOp::subtract, x, second.back()));
    } else {
      second.push_back(make(to, ShaderOp::exponent_of, x));
      made.push_back(make(to, ShaderOp::mantissa_of, x));
    }
  }
  const Pointee at = place(call, word(in.operands, 3));
  second = words_of(second);
  if (scalars(at.type) != second.size()) damaged("another type is stored");
  this->store(to, at, second);
  return made;
}

Scalars Lowering::glsl_vectors(GlslOp op, const std::vector<Scalars>& of, ShaderRegion& to) {
  using enum GlslOp;
  const auto multiply = [&](ShaderValue x, ShaderValue y) {
    return make(to, ShaderOp::multiply, x, y);
  };
  const auto subtract = [&](ShaderValue x, ShaderValue y) {
    return make(to, ShaderOp::subtract, x, y);
  };
  const Scalars& a = of[0];
  const auto number = [&](float value) { return constant_like(a[0], value); };
  const std::size_t wanted = op == length || op == normalize                  ? 1
                             : op == distance || op == cross || op == reflect ? 2
                                                                              : 3;
  if (of.size() < wanted) damaged("a function has too few operands");
  for (std::size_t i = 1; i < wanted; ++i) {
    if (of[i].size() != (op == refract && i == 2 ? 1 : a.size()))
      damaged("operands have two sizes");
  }
  Scalars made;
  switch (op) {
    case length: return {make(to, ShaderOp::square_root, dot(to, a, a))};
    case distance: {
      Scalars apart;
      for (std::size_t i = 0; i < a.size(); ++i) apart.push_back(subtract(a[i], of[1][i]));
      return {make(to, ShaderOp::square_root, dot(to, apart, apart))};
    }
    case normalize: {
      const ShaderValue scale = make(to, ShaderOp::inverse_square_root, dot(to, a, a));
      for (const ShaderValue x : a) made.push_back(multiply(x, scale));
      return made;
    }
    case cross: {
      if (a.size() != 3) damaged("a cross product is of three numbers");
      const Scalars& b = of[1];
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
        made.push_back(subtract(multiply(a[j], b[k]), multiply(a[k], b[j])));
      }
      return made;
    }
    case face_forward: {
      const ShaderValue keeps = make(to, ShaderOp::less, dot(to, of[2], of[1]), number(0.0f));
      for (const ShaderValue x : a) {
        made.push_back(make(to, ShaderOp::select, keeps, x, make(to, ShaderOp::negate, x)));
      }
      return made;
    }
    case reflect: {  // a - (2 dot(n, a)) n
      const ShaderValue twice = multiply(number(2.0f), dot(to, of[1], a));
      for (std::size_t i = 0; i < a.size(); ++i) {
        made.push_back(subtract(a[i], multiply(twice, of[1][i])));
      }
      return made;
    }
    default: {                     // refract
      ShaderValue eta = of[2][0];  // a float, whatever the vectors are of
      if (is_double(a[0]) && !is_double(eta)) {
        eta = convert_to_double(to, ShaderOp::double_of_float, eta);
      }
      const ShaderValue cosine = dot(to, of[1], a);
      // k = 1 - (eta eta) (1 - cosine cosine)
      const ShaderValue k =
          subtract(number(1.0f),
                   multiply(multiply(eta, eta), subtract(number(1.0f), multiply(cosine, cosine))));
      const ShaderValue none = make(to, ShaderOp::less, k, number(0.0f));
      const ShaderValue along =
          make(to, ShaderOp::add, multiply(eta, cosine), make(to, ShaderOp::square_root, k));
      for (std::size_t i = 0; i < a.size(); ++i) {
        made.push_back(make(to, ShaderOp::select, none, number(0.0f),
                            subtract(multiply(eta, a[i]), multiply(along, of[1][i]))));
      }
      return made;
    }
  }
}

Scalars Lowering::glsl_packs(GlslOp op, const Scalars& a, ShaderRegion& to) {
  using enum GlslOp;
  const bool packs = op <= pack_half_2x16;
  const bool by_byte = op == pack_snorm_4x8 || op == pack_unorm_4x8 || op == unpack_snorm_4x8 ||
                       op == unpack_unorm_4x8;
  const bool is_signed = op == pack_snorm_4x8 || op == pack_snorm_2x16 || op == unpack_snorm_4x8 ||
                         op == unpack_snorm_2x16;
  const bool is_half = op == pack_half_2x16 || op == unpack_half_2x16;
  const std::uint32_t parts = by_byte ? 4 : 2, width = 32 / parts;
  const ShaderValue mask = whole((1u << width) - 1);
  const auto full = static_cast<float>((1u << (is_signed ? width - 1 : width)) - 1);
  if (packs) {
    if (a.size() != parts) damaged("a function has too few operands");
    ShaderValue all = whole(0);
    for (std::uint32_t i = 0; i < parts; ++i) {
      ShaderValue bits = kNoValue;
      if (is_half) {
        bits = make(to, ShaderOp::to_half, a[i]);
      } else {
        const ShaderValue low = constant(is_signed ? -1.0f : 0.0f);
        const ShaderValue cut =
            make(to, ShaderOp::minimum, make(to, ShaderOp::maximum, a[i], low), constant(1.0f));
        const ShaderValue scaled =
            make(to, ShaderOp::round_even, make(to, ShaderOp::multiply, cut, constant(full)));
        bits = make(to, ShaderOp::bit_and, make(to, ShaderOp::to_signed, scaled), mask);
      }
      all = make(to, ShaderOp::bit_or, all, make(to, ShaderOp::shift_left, bits, whole(i * width)));
    }
    return {all};
  }
  Scalars made;
  for (std::uint32_t i = 0; i < parts; ++i) {
    const ShaderValue bits =
        make(to, is_signed ? ShaderOp::extract_bits_signed : ShaderOp::extract_bits_unsigned, a[0],
             whole(i * width), whole(width));
    if (is_half) {
      made.push_back(make(to, ShaderOp::from_half, bits));
      continue;
    }
    const ShaderValue value =
        make(to, ShaderOp::divide, make(to, ShaderOp::from_signed, bits), constant(full));
    made.push_back(is_signed
                       ? make(to, ShaderOp::minimum,
                              make(to, ShaderOp::maximum, value, constant(-1.0f)), constant(1.0f))
                       : value);
  }
  return made;
}

namespace {

/// A matrix, column after column, without a column and a row.
Scalars without(const Scalars& m, std::uint32_t n, std::uint32_t column, std::uint32_t row) {
  Scalars made;
  for (std::uint32_t c = 0; c < n; ++c) {
    for (std::uint32_t r = 0; r < n; ++r) {
      if (c != column && r != row) made.push_back(m[c * n + r]);
    }
  }
  return made;
}

}  // namespace

/// By the first column: m[0] M00 - m[1] M01 + ..., from left to right.
ShaderValue Lowering::determinant(const Scalars& m, std::uint32_t n, ShaderRegion& to) {
  if (n == 1) return m[0];
  ShaderValue sum = kNoValue;
  for (std::uint32_t row = 0; row < n; ++row) {
    const ShaderValue part =
        make(to, ShaderOp::multiply, m[row], determinant(without(m, n, 0, row), n - 1, to));
    sum = row == 0 ? part : make(to, row % 2 == 1 ? ShaderOp::subtract : ShaderOp::add, sum, part);
  }
  return sum;
}

/// The transposed cofactors, each divided by the determinant.
Scalars Lowering::inverse(const Scalars& m, std::uint32_t n, ShaderRegion& to) {
  const ShaderValue all = determinant(m, n, to);
  Scalars made;
  for (std::uint32_t column = 0; column < n; ++column) {
    for (std::uint32_t row = 0; row < n; ++row) {
      ShaderValue minor = determinant(without(m, n, row, column), n - 1, to);
      if ((column + row) % 2 == 1) minor = make(to, ShaderOp::negate, minor);
      made.push_back(make(to, ShaderOp::divide, minor, all));
    }
  }
  return made;
}

}  // namespace softfocus

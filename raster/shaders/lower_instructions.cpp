#include "raster/shaders/lowering.h"

#include <optional>

namespace softfocus {

// The instructions by kind. Each returns the scalars of its result.

Scalars Lowering::result(Call& call, const SpirvInstruction& in, ShaderRegion& to) {
  using enum SpirvOp;
  switch (in.op) {
    case SpirvOp::load: return this->load(to, place(call, word(in.operands, 0)));
    case phi: {
      const std::uint32_t first = call.phis.at(in.result);
      Scalars values;
      for (std::uint32_t i = 0; i < scalars(in.type); ++i) values.push_back(get(to, first + i));
      return values;
    }
    case function_call: return call_result(call, in, to);
    case ext_inst: return glsl_result(call, in, to);
    case vector_extract_dynamic:
    case vector_insert_dynamic:
    case vector_shuffle:
    case composite_construct:
    case composite_extract:
    case composite_insert:
    case copy_object:
    case copy_logical:
    case SpirvOp::select:
    case any:
    case all: return vector_result(call, in, to);
    case transpose:
    case vector_times_scalar:
    case matrix_times_scalar:
    case vector_times_matrix:
    case matrix_times_vector:
    case matrix_times_matrix:
    case outer_product:
    case SpirvOp::dot: return matrix_result(call, in, to);
    case sampled_image:
    case image:
    case image_sample_implicit_lod:
    case image_sample_explicit_lod:
    case image_sample_dref_implicit_lod:
    case image_sample_dref_explicit_lod:
    case image_sample_proj_implicit_lod:
    case image_sample_proj_explicit_lod:
    case image_sample_proj_dref_implicit_lod:
    case image_sample_proj_dref_explicit_lod:
    case image_fetch:
    case image_gather:
    case image_dref_gather:
    case image_query_size_lod:
    case image_query_size:
    case image_query_lod:
    case image_query_levels: return sample_result(call, in, to);
    default: return numbers_result(call, in, to);
  }
}

Scalars Lowering::call_result(Call& call, const SpirvInstruction& in, ShaderRegion& to) {
  const Words& w = in.operands;
  const auto found = module_.functions.find(word(w, 0));
  if (found == module_.functions.end()) damaged("a function is called that is not there");
  Call inner{.function = &found->second, .depth = call.depth + 1};
  if (w.size() - 1 != inner.function->parameters.size()) damaged("a call has other parameters");
  if (inner.function->returns != in.type) damaged("a call returns another type");
  for (std::size_t i = 0; i + 1 < w.size(); ++i) {
    const SpirvInstruction& parameter = inner.function->parameters[i];
    if (type(parameter.type).kind == SpirvKind::pointer) {
      inner.places[parameter.result] = place(call, w[i + 1]);
    } else {
      inner.values[parameter.result] = value(call, w[i + 1]);
      inner.types[parameter.result] = parameter.type;
      if (inner.values[parameter.result].size() != scalars(parameter.type)) {
        damaged("a call has other parameters");
      }
    }
  }
  const ShaderLine line = line_;
  run_call(inner, to);
  line_ = line;
  Scalars values;
  for (std::uint32_t i = 0; i < scalars(in.type); ++i) values.push_back(get(to, inner.result + i));
  return values;
}

Scalars Lowering::vector_result(Call& call, const SpirvInstruction& in, ShaderRegion& to) {
  const Words& w = in.operands;
  using enum SpirvOp;
  switch (in.op) {
    case copy_object:
    case copy_logical: return value(call, word(w, 0));
    case composite_construct: {
      Scalars made;
      for (const SpirvId id : w) {
        const Scalars of = value(call, id);
        made.insert(made.end(), of.begin(), of.end());
      }
      return made;
    }
    case vector_shuffle: {
      Scalars both = numbers(call, word(w, 0));
      const Scalars second = numbers(call, word(w, 1));
      both.insert(both.end(), second.begin(), second.end());
      if (both.empty()) damaged("a vector has no parts");
      Scalars made;
      for (const std::uint32_t i : w.subspan(2)) {
        if (i != ~0u && i >= both.size()) damaged("a shuffle takes what is not there");
        made.push_back(i == ~0u ? constant_like(both[0], 0.0f) : both[i]);
      }
      return made;
    }
    case composite_extract:
    case composite_insert: {
      const bool inserts = in.op == composite_insert;
      const SpirvId whole_id = word(w, inserts ? 1 : 0);
      Scalars all = value(call, whole_id);
      SpirvId at = inserts ? in.type : type_of(call, whole_id);
      std::uint32_t first = 0;
      for (const std::uint32_t i : w.subspan(inserts ? 2 : 1)) {
        const SpirvType& of = type(at);
        if (of.kind == SpirvKind::structure) {
          if (i >= of.members.size()) damaged("a structure has no such member");
          for (std::uint32_t k = 0; k < i; ++k) first += scalars(of.members[k]);
          at = of.members[i];
        } else {
          if (of.element == 0 || i >= of.count) damaged("a part lies beyond its whole");
          first += i * scalars(of.element);
          at = of.element;
        }
      }
      if (!inserts) return part(all, first, scalars(at));
      const Scalars object = value(call, w[0]);
      if (first + object.size() > all.size()) damaged("a part lies beyond its whole");
      std::copy(object.begin(), object.end(), all.begin() + first);
      return all;
    }
    case vector_extract_dynamic: {
      const Scalars all = numbers(call, word(w, 0));
      if (all.empty()) damaged("a vector has no parts");
      const ShaderValue index =
          clamped(to, scalar(call, word(w, 1)), static_cast<std::uint32_t>(all.size()));
      ShaderValue chosen = all[0];
      for (std::uint32_t i = 1; i < all.size(); ++i) {
        chosen = make(to, ShaderOp::select, make(to, ShaderOp::equal_integers, index, whole(i)),
                      all[i], chosen);
      }
      return {chosen};
    }
    case vector_insert_dynamic: {
      Scalars all = numbers(call, word(w, 0));
      const Scalars object = numbers(call, word(w, 1));
      if (all.empty() || object.size() != 1) damaged("a vector has no parts");
      const ShaderValue index =
          clamped(to, scalar(call, word(w, 2)), static_cast<std::uint32_t>(all.size()));
      for (std::uint32_t i = 0; i < all.size(); ++i) {
        all[i] = make(to, ShaderOp::select, make(to, ShaderOp::equal_integers, index, whole(i)),
                      object[0], all[i]);
      }
      return all;
    }
    case SpirvOp::select: {
      const Scalars condition = value(call, word(w, 0));
      const Scalars yes = numbers(call, word(w, 1)), no = numbers(call, word(w, 2));
      if (yes.size() != no.size() || (condition.size() != 1 && condition.size() != yes.size())) {
        damaged("a choice is between two types");
      }
      Scalars made;
      for (std::size_t i = 0; i < yes.size(); ++i) {
        const ShaderValue is = condition[condition.size() == 1 ? 0 : i];
        made.push_back(make(to, ShaderOp::select, is, yes[i], no[i]));
      }
      return made;
    }
    default: {  // any, all
      const Scalars all = value(call, word(w, 0));
      if (all.empty()) damaged("a vector has no parts");
      ShaderValue joined = all[0];
      for (std::size_t i = 1; i < all.size(); ++i) {
        joined = make(to, in.op == any ? ShaderOp::bit_or : ShaderOp::bit_and, joined, all[i]);
      }
      return {joined};
    }
  }
}

Scalars Lowering::matrix_result(Call& call, const SpirvInstruction& in, ShaderRegion& to) {
  const Words& w = in.operands;
  const Scalars a = numbers(call, word(w, 0));
  const SpirvType& of_a = type(type_of(call, w[0]));
  using enum SpirvOp;
  if (in.op == transpose) {
    if (of_a.kind != SpirvKind::matrix) damaged("a matrix is none");
    const std::uint32_t rows = type(of_a.element).count;
    Scalars made;
    for (std::uint32_t row = 0; row < rows; ++row) {
      for (std::uint32_t column = 0; column < of_a.count; ++column) {
        made.push_back(a[column * rows + row]);
      }
    }
    return made;
  }
  const Scalars b = numbers(call, word(w, 1));
  const SpirvType& of_b = type(type_of(call, w[1]));
  switch (in.op) {
    case vector_times_scalar:
    case matrix_times_scalar: {
      if (b.size() != 1) damaged("a scalar is none");
      Scalars made;
      for (const ShaderValue of : a) made.push_back(make(to, ShaderOp::multiply, of, b[0]));
      return made;
    }
    case outer_product: {
      Scalars made;
      for (const ShaderValue column : b) {
        for (const ShaderValue row : a) made.push_back(make(to, ShaderOp::multiply, row, column));
      }
      return made;
    }
    case SpirvOp::dot: return {this->dot(to, a, b)};
    case vector_times_matrix: {
      if (of_b.kind != SpirvKind::matrix) damaged("a matrix is none");
      Scalars made;
      for (std::uint32_t column = 0; column < of_b.count; ++column) {
        const auto rows = static_cast<std::uint32_t>(a.size());
        made.push_back(this->dot(to, a, part(b, column * rows, rows)));
      }
      return made;
    }
    default: {  // a matrix times a vector, or times each column of a matrix
      if (of_a.kind != SpirvKind::matrix) damaged("a matrix is none");
      const std::uint32_t rows = type(of_a.element).count, inner = of_a.count;
      if (b.empty() || b.size() % inner != 0) damaged("matrices of two sizes are multiplied");
      Scalars made;
      for (std::uint32_t column = 0; column < b.size() / inner; ++column) {
        for (std::uint32_t row = 0; row < rows; ++row) {
          Scalars of_row;
          for (std::uint32_t i = 0; i < inner; ++i) of_row.push_back(a[i * rows + row]);
          made.push_back(this->dot(to, of_row, part(b, column * inner, inner)));
        }
      }
      return made;
    }
  }
}

namespace {

/// An instruction of numbers, component by component: the operation; whether the operands change
/// places; whether the result is turned round.
struct Mapped {
  ShaderOp op{};
  bool swaps = false, turns = false;
};

std::optional<Mapped> mapped(SpirvOp op) {
  using enum SpirvOp;
  using To = ShaderOp;
  switch (op) {
    case convert_float_to_unsigned: return Mapped{To::to_unsigned};
    case convert_float_to_signed: return Mapped{To::to_signed};
    case convert_signed_to_float: return Mapped{To::from_signed};
    case convert_unsigned_to_float: return Mapped{To::from_unsigned};
    case signed_negate: return Mapped{To::negate_integer};
    case float_negate: return Mapped{To::negate};
    case integer_add: return Mapped{To::add_integers};
    case float_add: return Mapped{To::add};
    case integer_sub: return Mapped{To::subtract_integers};
    case float_sub: return Mapped{To::subtract};
    case integer_mul: return Mapped{To::multiply_integers};
    case float_mul: return Mapped{To::multiply};
    case unsigned_div: return Mapped{To::divide_unsigned};
    case signed_div: return Mapped{To::divide_signed};
    case float_div: return Mapped{To::divide};
    case unsigned_mod: return Mapped{To::modulo_unsigned};
    case signed_rem: return Mapped{To::remainder_signed};
    case signed_mod: return Mapped{To::modulo_signed};
    case float_rem: return Mapped{To::remainder};
    case float_mod: return Mapped{To::modulo};
    case is_inf: return Mapped{To::is_infinite};
    case logical_equal: return Mapped{To::equal_integers};
    case logical_not_equal: return Mapped{To::bit_xor};
    case logical_or: return Mapped{To::bit_or};
    case logical_and: return Mapped{To::bit_and};
    case logical_not: return Mapped{To::bit_not};
    case integer_equal: return Mapped{To::equal_integers};
    case integer_not_equal: return Mapped{To::equal_integers, false, true};
    case unsigned_greater_than: return Mapped{To::less_unsigned, true};
    case signed_greater_than: return Mapped{To::less_signed, true};
    case unsigned_greater_than_equal: return Mapped{To::less_equal_unsigned, true};
    case signed_greater_than_equal: return Mapped{To::less_equal_signed, true};
    case unsigned_less_than: return Mapped{To::less_unsigned};
    case signed_less_than: return Mapped{To::less_signed};
    case unsigned_less_than_equal: return Mapped{To::less_equal_unsigned};
    case signed_less_than_equal: return Mapped{To::less_equal_signed};
    case float_ord_equal: return Mapped{To::equal};
    case float_unord_not_equal: return Mapped{To::not_equal};
    case float_ord_less_than: return Mapped{To::less};
    case float_ord_greater_than: return Mapped{To::less, true};
    case float_ord_less_than_equal: return Mapped{To::less_equal};
    case float_ord_greater_than_equal: return Mapped{To::less_equal, true};
    case float_unord_less_than: return Mapped{To::less_equal, true, true};
    case float_unord_greater_than: return Mapped{To::less_equal, false, true};
    case float_unord_less_than_equal: return Mapped{To::less, true, true};
    case float_unord_greater_than_equal: return Mapped{To::less, false, true};
    case shift_right_logical: return Mapped{To::shift_right};
    case shift_right_arithmetic: return Mapped{To::shift_right_signed};
    case shift_left_logical: return Mapped{To::shift_left};
    case bitwise_or: return Mapped{To::bit_or};
    case bitwise_xor: return Mapped{To::bit_xor};
    case bitwise_and: return Mapped{To::bit_and};
    case bitwise_not: return Mapped{To::bit_not};
    case bit_reverse: return Mapped{To::reverse_bits};
    case bit_count: return Mapped{To::count_bits};
    case derivative_x:
    case derivative_x_fine: return Mapped{To::derivative_x};
    case derivative_y:
    case derivative_y_fine: return Mapped{To::derivative_y};
    case derivative_x_coarse: return Mapped{To::derivative_x_coarse};
    case derivative_y_coarse: return Mapped{To::derivative_y_coarse};
    default: return std::nullopt;
  }
}

bool has_one_operand(SpirvOp op) {
  using enum SpirvOp;
  return op <= float_negate || op == is_inf || op == logical_not || op == bitwise_not ||
         op == bit_reverse || op == bit_count || op >= derivative_x;
}

}  // namespace

std::optional<std::uint32_t> fold_spirv_op(SpirvOp op, std::span<const std::uint32_t> operands) {
  const std::optional<Mapped> one = mapped(op);
  if (!one || one->op < ShaderOp::add_integers || op >= SpirvOp::derivative_x ||
      operands.size() != (has_one_operand(op) ? 1 : 2)) {
    return std::nullopt;
  }
  std::uint32_t a = operands.front(), b = operands.back();
  if (one->swaps) std::swap(a, b);
  const std::uint32_t made = fold_shader_op(one->op, a, b, 0);
  return one->turns ? ~made : made;
}

Scalars Lowering::numbers_result(Call& call, const SpirvInstruction& in, ShaderRegion& to) {
  const Words& w = in.operands;
  Scalars a = numbers(call, word(w, 0));
  const Scalars b = w.size() > 1 ? numbers(call, w[1]) : Scalars{};
  const bool gives_doubles = module_.has_doubles && holds_doubles(in.type);
  const auto of_b = [&](std::size_t i) {
    if (i >= b.size()) damaged("an instruction has too few operands");
    return b[i];
  };
  if (!b.empty() && b.size() != a.size() && in.op != SpirvOp::bit_field_s_extract &&
      in.op != SpirvOp::bit_field_u_extract) {
    damaged("operands have two sizes");
  }
  using enum SpirvOp;
  Scalars made;
  if (const std::optional<Mapped> one = mapped(in.op)) {
    if (one->op >= ShaderOp::derivative_x && one->op <= ShaderOp::derivative_y_coarse) {
      tree_.has_derivatives = true;
    }
    if (gives_doubles && (one->op == ShaderOp::from_signed || one->op == ShaderOp::from_unsigned)) {
      for (const ShaderValue of : a) made.push_back(convert_to_double(to, one->op, of));
      return made;
    }
    for (std::size_t i = 0; i < a.size(); ++i) {
      const ShaderValue second = has_one_operand(in.op) ? kNoValue : of_b(i);
      const ShaderValue is =
          one->swaps ? make(to, one->op, second, a[i]) : make(to, one->op, a[i], second);
      made.push_back(one->turns ? make(to, ShaderOp::bit_not, is) : is);
    }
    return made;
  }
  switch (in.op) {
    case bitcast: {
      // Processors disagree on the bits of a NaN: as a whole number each is the same.
      const auto is_float = [&](SpirvId id) {
        const SpirvType& of = type(id);
        return (of.kind == SpirvKind::vector ? type(of.element).kind : of.kind) ==
               SpirvKind::floating;
      };
      if (!is_float(type_of(call, w[0])) || is_float(in.type)) return a;
      if (module_.has_doubles && holds_doubles(type_of(call, w[0]))) return bits_of_doubles(to, a);
      for (const ShaderValue of : a) {
        made.push_back(make(to, ShaderOp::select, make(to, ShaderOp::not_equal, of, of),
                            whole(0x7FC00000u), of));
      }
      return made;
    }
    case unsigned_convert:
    case signed_convert: return a;
    case float_convert:
      for (const ShaderValue of : a) {
        made.push_back(is_double(of) == gives_doubles ? of
                       : gives_doubles ? convert_to_double(to, ShaderOp::double_of_float, of)
                                       : make(to, ShaderOp::float_of_double, of));
      }
      return made;
    case is_nan:
      for (const ShaderValue of : a) made.push_back(make(to, ShaderOp::not_equal, of, of));
      return made;
    case float_unord_equal:  // equal, or one is NaN: not (a < b or b < a)
    case float_ord_not_equal:
      for (std::size_t i = 0; i < a.size(); ++i) {
        const ShaderValue differs =
            make(to, ShaderOp::bit_or, make(to, ShaderOp::less, a[i], of_b(i)),
                 make(to, ShaderOp::less, of_b(i), a[i]));
        made.push_back(in.op == float_ord_not_equal ? differs
                                                    : make(to, ShaderOp::bit_not, differs));
      }
      return made;
    case fwidth:
    case fwidth_fine:
    case fwidth_coarse: {
      tree_.has_derivatives = true;
      const bool coarse = in.op == fwidth_coarse;
      for (const ShaderValue of : a) {
        const ShaderValue x =
            make(to, coarse ? ShaderOp::derivative_x_coarse : ShaderOp::derivative_x, of);
        const ShaderValue y =
            make(to, coarse ? ShaderOp::derivative_y_coarse : ShaderOp::derivative_y, of);
        made.push_back(make(to, ShaderOp::add, make(to, ShaderOp::absolute, x),
                            make(to, ShaderOp::absolute, y)));
      }
      return made;
    }
    case integer_add_carry:
    case integer_sub_borrow: {
      Scalars second;
      for (std::size_t i = 0; i < a.size(); ++i) {
        const bool adds = in.op == integer_add_carry;
        const ShaderValue sum =
            make(to, adds ? ShaderOp::add_integers : ShaderOp::subtract_integers, a[i], of_b(i));
        const ShaderValue over = adds ? make(to, ShaderOp::less_unsigned, sum, a[i])
                                      : make(to, ShaderOp::less_unsigned, a[i], of_b(i));
        made.push_back(sum);
        second.push_back(make(to, ShaderOp::bit_and, over, whole(1)));
      }
      made.insert(made.end(), second.begin(), second.end());
      return made;
    }
    case unsigned_mul_extended:
    case signed_mul_extended: {
      Scalars second;
      for (std::size_t i = 0; i < a.size(); ++i) {
        made.push_back(make(to, ShaderOp::multiply_integers, a[i], of_b(i)));
        second.push_back(make(to,
                              in.op == signed_mul_extended ? ShaderOp::multiply_high_signed
                                                           : ShaderOp::multiply_high_unsigned,
                              a[i], of_b(i)));
      }
      made.insert(made.end(), second.begin(), second.end());
      return made;
    }
    case bit_field_s_extract:
    case bit_field_u_extract: {
      const ShaderValue first = scalar(call, word(w, 1)), count = scalar(call, word(w, 2));
      for (const ShaderValue of : a) {
        made.push_back(make(to,
                            in.op == bit_field_s_extract ? ShaderOp::extract_bits_signed
                                                         : ShaderOp::extract_bits_unsigned,
                            of, first, count));
      }
      return made;
    }
    case bit_field_insert: {
      const ShaderValue first = scalar(call, word(w, 2)), count = scalar(call, word(w, 3));
      // The field's bits of ones: all but the last `count`, turned round; none of 32.
      const ShaderValue ones =
          make(to, ShaderOp::extract_bits_unsigned, whole(~0u), whole(0), count);
      const ShaderValue field = make(to, ShaderOp::shift_left, ones, first);
      for (std::size_t i = 0; i < a.size(); ++i) {
        const ShaderValue kept =
            make(to, ShaderOp::bit_and, a[i], make(to, ShaderOp::bit_not, field));
        const ShaderValue put =
            make(to, ShaderOp::bit_and, make(to, ShaderOp::shift_left, of_b(i), first), field);
        made.push_back(make(to, ShaderOp::bit_or, kept, put));
      }
      return made;
    }
    default: refuse("instruction " + std::to_string(static_cast<int>(in.op)) + " is not supported");
  }
}

Scalars Lowering::sample_result(Call& call, const SpirvInstruction& in, ShaderRegion& to) {
  const Words& w = in.operands;
  using enum SpirvOp;
  const Scalars texture = value(call, word(w, 0));
  if (in.op == sampled_image) {
    const Scalars sampler = value(call, word(w, 1));
    if (texture.size() != 1 || sampler.size() != 1) damaged("a sampler is none");
    return {texture[0], sampler[0]};
  }
  if (texture.empty()) damaged("a texture is none");
  if (in.op == image) return {texture[0]};
  const SpirvType* of = &type(type_of(call, w[0]));
  if (of->kind == SpirvKind::sampled_image) of = &type(of->element);
  if (of->kind != SpirvKind::image) damaged("a texture is none");
  if (of->is_multisampled) refuse("multisampled textures are not supported");
  if (of->is_arrayed && of->dim == SpirvDim::cube) {
    refuse("samplerCubeArray is not supported; samplerCube and sampler2DArray are");
  }
  // Sampled as a sampler2DArray.
  const bool is_line_array = of->is_arrayed && of->dim == SpirvDim::one;

  ShaderSample sample{.dim = of->dim,
                      .shape = texture_shape(*of),
                      .is_shadow = of->is_shadow,
                      .is_integer = type(of->element).kind == SpirvKind::integer,
                      .texture = texture[0],
                      .sampler = texture.back()};
  const std::uint32_t places = (of->dim == SpirvDim::one                                  ? 1u
                                : of->dim == SpirvDim::three || of->dim == SpirvDim::cube ? 3u
                                                                                          : 2u) +
                               (of->is_arrayed && in.op != image_query_lod ? 1u : 0u);
  const bool has_place =
      in.op != image_query_size_lod && in.op != image_query_size && in.op != image_query_levels;
  std::size_t next = 1;
  if (has_place) {
    Scalars at = value(call, word(w, next++));
    const bool projects = in.op == image_sample_proj_implicit_lod ||
                          in.op == image_sample_proj_explicit_lod ||
                          in.op == image_sample_proj_dref_implicit_lod ||
                          in.op == image_sample_proj_dref_explicit_lod;
    if (at.size() < places + (projects ? 1 : 0)) damaged("a texture's place has too few parts");
    if (projects) {
      for (std::uint32_t i = 0; i < places; ++i) {
        at[i] = make(to, ShaderOp::divide, at[i], at[places]);
      }
    }
    std::copy_n(at.begin(), places, sample.at.begin());
    if (is_line_array && places == 2) {
      sample.at[2] = sample.at[1];
      sample.at[1] = whole(0);  // samplers take the middle; the level of detail needs a constant
    }
    const bool compares =
        in.op == image_sample_dref_implicit_lod || in.op == image_sample_dref_explicit_lod ||
        in.op == image_sample_proj_dref_implicit_lod ||
        in.op == image_sample_proj_dref_explicit_lod || in.op == image_dref_gather;
    if (compares) {
      sample.compared = scalar(call, word(w, next++));
      if (projects) sample.compared = make(to, ShaderOp::divide, sample.compared, at[places]);
    }
  }
  const std::uint32_t results = scalars(in.type);
  switch (in.op) {
    case image_fetch: sample.kind = SampleKind::fetch; break;
    case image_gather:
      sample.kind = SampleKind::gather;
      sample.channel = static_cast<int>(tree_.bits(scalar(call, word(w, next++))) & 3);
      break;
    case image_dref_gather: sample.kind = SampleKind::gather; break;
    case image_query_size:
    case image_query_size_lod:
      sample.kind = SampleKind::size;
      sample.more[0] = in.op == image_query_size ? whole(0) : scalar(call, word(w, next++));
      break;
    case image_query_levels: sample.kind = SampleKind::levels; break;
    case image_query_lod: sample.kind = SampleKind::query_lod; break;
    case image_sample_explicit_lod:
    case image_sample_dref_explicit_lod:
    case image_sample_proj_explicit_lod:
    case image_sample_proj_dref_explicit_lod: sample.kind = SampleKind::level; break;
    default: sample.kind = SampleKind::implicit; break;
  }
  Scalars offsets;  // of a gather, for each of its texels
  if (next < w.size() && has_place) {
    const std::uint32_t bits = w[next++];
    if ((bits & kImageBias) != 0) sample.more[0] = scalar(call, word(w, next++));
    if ((bits & kImageLod) != 0) sample.more[0] = scalar(call, word(w, next++));
    if ((bits & kImageGrad) != 0) {
      sample.kind = SampleKind::gradient;
      std::size_t put = 0;
      for (int axis = 0; axis < 2; ++axis) {
        const Scalars slope = value(call, word(w, next++));
        for (std::size_t i = 0; i < 3; ++i) {
          sample.more.at(put++) = i < slope.size() ? slope[i] : whole(0);
        }
      }
    }
    if ((bits & (kImageConstOffset | kImageOffset)) != 0) {
      const Scalars offset = value(call, word(w, next++));
      std::copy_n(offset.begin(), std::min<std::size_t>(3, offset.size()), sample.offset.begin());
    }
    if ((bits & kImageConstOffsets) != 0) offsets = value(call, word(w, next++));
  }
  if (sample.kind == SampleKind::fetch && sample.more[0] == kNoValue) sample.more[0] = whole(0);
  if (sample.kind == SampleKind::implicit || sample.kind == SampleKind::query_lod) {
    // The level takes differences of the place; without a fragment there are none.
    if (module_.stage == ShaderStage::fragment) tree_.has_derivatives = true;
    sample.more[1] = sample.more[0];
  }
  if (results > 4) damaged("a texture gives more than four numbers");
  const auto sampled = [&](std::uint32_t count) {
    ShaderInstruction& made = add(to, ShaderOp::sample);
    made.place = static_cast<std::uint32_t>(tree_.samples.size());
    Scalars values;
    for (std::uint32_t i = 0; i < count; ++i) {
      sample.to[i] = tree_.new_value();
      values.push_back(sample.to[i]);
    }
    tree_.samples.push_back(sample);
    return values;
  };
  if (!offsets.empty()) {
    if (sample.kind != SampleKind::gather || offsets.size() != 8) damaged("offsets are not four");
    Scalars values;
    for (std::size_t i = 0; i < results; ++i) {
      std::copy_n(offsets.begin() + static_cast<std::ptrdiff_t>(2 * i), 2, sample.offset.begin());
      values.push_back(sampled(4)[3]);  // the upper left of four
    }
    return values;
  }
  if (is_line_array && sample.kind == SampleKind::size && results == 2) {
    const Scalars size = sampled(3);
    return {size[0], size[2]};
  }
  return sampled(results);
}

}  // namespace softfocus

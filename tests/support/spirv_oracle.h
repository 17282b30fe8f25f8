#pragma once
// SPIR-V for one pixel, as the specification reads: blocks one after the other, memory as numbers,
// calls that call. No masks, no inlining, nothing known beforehand. Only the arithmetic of single
// numbers is the shaders' own (fold_shader_op).

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <numbers>
#include <span>
#include <vector>

#include "raster/images/texel.h"
#include "raster/shaders/shader_kernels.h"
#include "raster/shaders/shader_lanes.h"
#include "raster/shaders/spirv_module.h"

namespace softfocus::test {

struct OracleSettings {
  std::span<const std::uint32_t> uniforms{};  ///< as ShaderUniforms::words
  std::span<const ShaderTexture> textures{};
  Profile profile{};
  /// The bits of a number of an input: its decorations, and which number of it.
  std::function<std::uint32_t(const SpirvDecorations&, std::uint32_t)> input{};
  std::uint64_t most_blocks = 20000;  ///< that a pixel may run
};

struct OracleResult {
  bool is_killed = false, is_stopped = false;             ///< stopped: it ran too many blocks
  std::array<std::array<std::uint32_t, 4>, 8> outputs{};  ///< by location
  std::array<std::uint32_t, 4> position{};                ///< of a vertex
};

namespace spirv {

using Numbers = std::vector<std::uint32_t>;
using Words = std::span<const std::uint32_t>;
using To = ShaderOp;

struct Killed {};
struct Stopped {};

struct Pointer {
  Numbers* memory = nullptr;
  std::uint32_t first = 0;
  SpirvId type = 0;  ///< of what is there
};

struct Frame {
  const SpirvFunction* function = nullptr;
  std::map<SpirvId, Numbers> values{};
  std::map<SpirvId, Pointer> pointers{};
  std::deque<Numbers> memory{};
};

inline std::uint32_t bits_of(float x) { return std::bit_cast<std::uint32_t>(x); }

inline std::uint32_t fold(ShaderOp op, std::uint32_t a, std::uint32_t b = 0, std::uint32_t c = 0) {
  return fold_shader_op(op, a, b, c);
}

/// An operation on each number: the operands in turn, or the other way round; its result, or not.
struct Each {
  ShaderOp op{};
  bool swaps = false, turns = false;
};

inline const std::map<SpirvOp, Each>& each_number() {
  using enum SpirvOp;
  static const std::map<SpirvOp, Each> table{
      {convert_float_to_unsigned, {To::to_unsigned}},
      {convert_float_to_signed, {To::to_signed}},
      {convert_signed_to_float, {To::from_signed}},
      {convert_unsigned_to_float, {To::from_unsigned}},
      {copy_object, {To::copy}},
      {signed_negate, {To::negate_integer}},
      {float_negate, {To::negate}},
      {integer_add, {To::add_integers}},
      {float_add, {To::add}},
      {integer_sub, {To::subtract_integers}},
      {float_sub, {To::subtract}},
      {integer_mul, {To::multiply_integers}},
      {float_mul, {To::multiply}},
      {unsigned_div, {To::divide_unsigned}},
      {signed_div, {To::divide_signed}},
      {float_div, {To::divide}},
      {unsigned_mod, {To::modulo_unsigned}},
      {signed_rem, {To::remainder_signed}},
      {signed_mod, {To::modulo_signed}},
      {float_rem, {To::remainder}},
      {float_mod, {To::modulo}},
      {is_inf, {To::is_infinite}},
      {logical_equal, {To::equal_integers}},
      {logical_not_equal, {To::equal_integers, false, true}},
      {logical_or, {To::bit_or}},
      {logical_and, {To::bit_and}},
      {logical_not, {To::bit_not}},
      {integer_equal, {To::equal_integers}},
      {integer_not_equal, {To::equal_integers, false, true}},
      {unsigned_greater_than, {To::less_unsigned, true}},
      {signed_greater_than, {To::less_signed, true}},
      {unsigned_greater_than_equal, {To::less_equal_unsigned, true}},
      {signed_greater_than_equal, {To::less_equal_signed, true}},
      {unsigned_less_than, {To::less_unsigned}},
      {signed_less_than, {To::less_signed}},
      {unsigned_less_than_equal, {To::less_equal_unsigned}},
      {signed_less_than_equal, {To::less_equal_signed}},
      {float_ord_equal, {To::equal}},
      {float_unord_not_equal, {To::not_equal}},
      {float_ord_less_than, {To::less}},
      {float_ord_greater_than, {To::less, true}},
      {float_ord_less_than_equal, {To::less_equal}},
      {float_ord_greater_than_equal, {To::less_equal, true}},
      {float_unord_less_than, {To::less_equal, true, true}},
      {float_unord_greater_than, {To::less_equal, false, true}},
      {float_unord_less_than_equal, {To::less, true, true}},
      {float_unord_greater_than_equal, {To::less, false, true}},
      {shift_right_logical, {To::shift_right}},
      {shift_right_arithmetic, {To::shift_right_signed}},
      {shift_left_logical, {To::shift_left}},
      {bitwise_or, {To::bit_or}},
      {bitwise_xor, {To::bit_xor}},
      {bitwise_and, {To::bit_and}},
      {bitwise_not, {To::bit_not}},
      {bit_reverse, {To::reverse_bits}},
      {bit_count, {To::count_bits}},
  };
  return table;
}

inline const std::map<GlslOp, ShaderOp>& each_of_glsl() {
  using enum GlslOp;
  static const std::map<GlslOp, ShaderOp> table{
      {round, To::round_even},
      {round_even, To::round_even},
      {trunc, To::truncate},
      {float_abs, To::absolute},
      {signed_abs, To::absolute_integer},
      {float_sign, To::sign},
      {signed_sign, To::sign_integer},
      {floor, To::floor},
      {ceil, To::ceiling},
      {fract, To::fraction},
      {sin, To::sine},
      {cos, To::cosine},
      {tan, To::tangent},
      {atan, To::arc_tangent},
      {atan2, To::arc_tangent_2},
      {pow, To::power},
      {exp, To::exponential},
      {log, To::logarithm},
      {exp2, To::exponential_2},
      {log2, To::logarithm_2},
      {sqrt, To::square_root},
      {inverse_sqrt, To::inverse_square_root},
      {float_min, To::minimum},
      {float_max, To::maximum},
      {unsigned_min, To::minimum_unsigned},
      {signed_min, To::minimum_signed},
      {unsigned_max, To::maximum_unsigned},
      {signed_max, To::maximum_signed},
      {fma, To::fused_multiply_add},
      {ldexp, To::scale_by_exponent},
      {find_lowest_bit, To::lowest_bit},
      {find_signed_highest_bit, To::highest_bit_signed},
      {find_unsigned_highest_bit, To::highest_bit_unsigned},
  };
  return table;
}

inline std::uint32_t plus(std::uint32_t a, std::uint32_t b) { return fold(To::add, a, b); }
inline std::uint32_t minus(std::uint32_t a, std::uint32_t b) { return fold(To::subtract, a, b); }
inline std::uint32_t times(std::uint32_t a, std::uint32_t b) { return fold(To::multiply, a, b); }
inline std::uint32_t less(std::uint32_t a, std::uint32_t b) { return fold(To::less, a, b); }
inline std::uint32_t clamped(std::uint32_t x, std::uint32_t low, std::uint32_t high) {
  return fold(To::minimum, fold(To::maximum, x, low), high);
}

/// Of two numbers; if one is NaN, the other.
inline std::uint32_t of_numbers(To pick, std::uint32_t a, std::uint32_t b) {
  return fold(To::not_equal, a, a) != 0 ? b : fold(pick, a, b);
}

inline std::uint32_t dot(Words a, Words b) {
  std::uint32_t sum = times(a[0], b[0]);
  for (std::size_t i = 1; i < a.size(); ++i) sum = plus(sum, times(a[i], b[i]));
  return sum;
}

inline Numbers minor_of(const Numbers& m, std::size_t n, std::size_t column, std::size_t row) {
  Numbers made;
  for (std::size_t c = 0; c < n; ++c) {
    for (std::size_t r = 0; r < n; ++r) {
      if (c != column && r != row) made.push_back(m[c * n + r]);
    }
  }
  return made;
}
inline std::uint32_t determinant(const Numbers& m, std::size_t n) {
  if (n == 1) return m[0];
  std::uint32_t sum = 0;
  for (std::size_t row = 0; row < n; ++row) {
    const std::uint32_t part = times(m[row], determinant(minor_of(m, n, 0, row), n - 1));
    sum = row == 0 ? part : row % 2 == 1 ? minus(sum, part) : plus(sum, part);
  }
  return sum;
}

class Oracle {
 public:
  Oracle(const SpirvModule& module, const OracleSettings& settings)
      : module_(module), settings_(settings), left_(settings.most_blocks) {
    std::size_t next_uniform = 0;
    for (const auto& [id, variable] : module.variables) {
      const SpirvId type = module.type(variable.type).element;
      const std::uint32_t count = module.type(type).scalars;
      Numbers& memory = memory_.emplace_back(count, 0);
      using enum SpirvStorage;
      if (variable.storage == uniform_constant || variable.storage == SpirvStorage::uniform ||
          variable.storage == push_constant) {
        for (std::uint32_t& word : memory) word = settings.uniforms[next_uniform++];
      } else if (variable.storage == input) {
        for (std::uint32_t i = 0; i < count; ++i) memory[i] = settings.input(decorations(id), i);
      } else if (variable.initial != 0) {
        memory = module.constants.at(variable.initial).words;
      }
      globals_[id] = {&memory, 0, type};
    }
  }

  OracleResult run() {
    OracleResult result;
    try {
      call(module_.functions.at(module_.main), {}, {});
    } catch (Killed) {
      result.is_killed = true;
    } catch (Stopped) {
      result.is_stopped = true;
    }
    for (const auto& [id, variable] : module_.variables) {
      const SpirvDecorations& of = decorations(id);
      if (variable.storage != SpirvStorage::output) continue;
      const Numbers& memory = *globals_.at(id).memory;
      const std::vector<SpirvDecorations>& members =
          decorations(module_.type(variable.type).element).members;
      const auto is_position = [](const SpirvDecorations& decoration) {
        return decoration.builtin == static_cast<int>(SpirvBuiltin::position);
      };
      // In a block it is the first member.
      if (is_position(of) || (!members.empty() && is_position(members[0]))) {
        std::copy_n(memory.begin(), 4, result.position.begin());
      }
      if (of.location < 0) continue;
      for (std::size_t i = 0; i < memory.size(); ++i) {
        const std::size_t at = static_cast<std::size_t>(of.component) + i % 4;
        result.outputs.at(static_cast<std::size_t>(of.location) + i / 4).at(at) = memory[i];
      }
    }
    return result;
  }

 private:
  const SpirvModule& module_;
  const OracleSettings& settings_;
  std::uint64_t left_;
  std::deque<Numbers> memory_{};
  std::map<SpirvId, Pointer> globals_{};
  std::map<SpirvId, SpirvId> types_{};  ///< of the values made so far

  const SpirvDecorations& decorations(SpirvId id) const {
    static const SpirvDecorations none;
    const auto found = module_.decorations.find(id);
    return found == module_.decorations.end() ? none : found->second;
  }

  Numbers call(const SpirvFunction& function, const std::map<SpirvId, Numbers>& values,
               const std::map<SpirvId, Pointer>& pointers) {
    Frame frame{.function = &function, .values = values, .pointers = pointers};
    for (const SpirvInstruction& in : function.parameters) types_[in.result] = in.type;
    for (const SpirvVariable& variable : function.variables) {
      const SpirvId type = module_.type(variable.type).element;
      Numbers& memory = frame.memory.emplace_back(module_.type(type).scalars, 0);
      if (variable.initial != 0) memory = module_.constants.at(variable.initial).words;
      frame.pointers[variable.id] = {&memory, 0, type};
    }
    SpirvId next = function.blocks.front().label, from = 0;
    while (true) {
      if (left_-- == 0) throw Stopped{};
      const SpirvBlock& block = function.blocks[function.block_of.at(next)];
      enter(frame, block, from);
      const SpirvInstruction& last = block.instructions.back();
      const Words& w = last.operands;
      from = next;
      using enum SpirvOp;
      switch (last.op) {
        case branch: next = w[0]; break;
        case branch_conditional: next = value(frame, w[0])[0] != 0 ? w[1] : w[2]; break;
        case switch_case: {
          const std::uint32_t selector = value(frame, w[0])[0];
          next = w[1];
          for (std::size_t i = 2; i < w.size(); i += 2) {
            if (w[i] == selector) next = w[i + 1];
          }
          break;
        }
        case return_value: return value(frame, w[0]);
        case kill:
        case terminate_invocation: throw Killed{};
        default: return {};
      }
    }
  }

  /// Runs a block but for its last instruction. Phis take their values all at once.
  void enter(Frame& frame, const SpirvBlock& block, SpirvId from) {
    std::map<SpirvId, Numbers> phis;
    for (const SpirvInstruction& in : block.instructions) {
      if (in.op != SpirvOp::phi) break;
      for (std::size_t i = 0; i < in.operands.size(); i += 2) {
        if (in.operands[i + 1] == from) phis[in.result] = value(frame, in.operands[i]);
      }
      types_[in.result] = in.type;
    }
    for (auto& [id, numbers] : phis) frame.values[id] = std::move(numbers);
    for (std::size_t i = 0; i + 1 < block.instructions.size(); ++i) {
      if (block.instructions[i].op != SpirvOp::phi) run(frame, block.instructions[i]);
    }
  }

  const Numbers& value(const Frame& frame, SpirvId id) const {
    const auto constant = module_.constants.find(id);
    return constant != module_.constants.end() ? constant->second.words : frame.values.at(id);
  }
  const SpirvType& type_of(SpirvId id) const {
    const auto constant = module_.constants.find(id);
    return module_.type(constant != module_.constants.end() ? constant->second.type
                                                            : types_.at(id));
  }
  Pointer pointer(const Frame& frame, SpirvId id) const {
    const auto found = frame.pointers.find(id);
    return found != frame.pointers.end() ? found->second : globals_.at(id);
  }
  Numbers loaded(const Pointer& from) const {
    const auto begin = from.memory->begin() + from.first;
    return {begin, begin + module_.type(from.type).scalars};
  }
  static void store(const Pointer& to, const Numbers& numbers) {
    std::copy(numbers.begin(), numbers.end(), to.memory->begin() + to.first);
  }

  /// The part of that number: the first of its numbers. `type` becomes the part's.
  std::uint32_t part(SpirvId& type, std::uint32_t number) const {
    const SpirvType& of = module_.type(type);
    if (of.kind == SpirvKind::structure) {
      std::uint32_t first = 0;
      for (std::uint32_t i = 0; i < number; ++i) first += module_.type(of.members[i]).scalars;
      type = of.members[number];
      return first;
    }
    const auto last = static_cast<std::int32_t>(of.count) - 1;
    const std::int32_t index = std::clamp(static_cast<std::int32_t>(number), 0, last);
    type = of.element;
    return static_cast<std::uint32_t>(index) * module_.type(type).scalars;
  }

  void run(Frame& frame, const SpirvInstruction& in) {
    const Words& w = in.operands;
    using enum SpirvOp;
    switch (in.op) {
      case SpirvOp::store: this->store(pointer(frame, w[0]), value(frame, w[1])); return;
      case copy_memory: this->store(pointer(frame, w[0]), loaded(pointer(frame, w[1]))); return;
      case access_chain:
      case in_bounds_access_chain: {
        Pointer at = pointer(frame, w[0]);
        for (const SpirvId index : w.subspan(1)) at.first += part(at.type, value(frame, index)[0]);
        frame.pointers[in.result] = at;
        return;
      }
      default: break;
    }
    frame.values[in.result] = made(frame, in);
    types_[in.result] = in.type;
  }

  // --- doubles: the machine's ---

  using Doubles = std::vector<double>;

  bool holds_doubles(const SpirvType& of) const {
    return of.element != 0 ? holds_doubles(module_.type(of.element))
                           : of.kind == SpirvKind::floating && of.scalars == 2;
  }
  bool is_of_doubles(const SpirvInstruction& in, Words operands) const {
    if (!module_.has_doubles) return false;
    using enum SpirvOp;
    // Words that only move.
    for (const SpirvOp moves : {load, function_call, composite_construct, composite_extract,
                                composite_insert, copy_object, phi}) {
      if (in.op == moves) return false;
    }
    bool has_any = holds_doubles(module_.type(in.type));
    for (const SpirvId id : operands) {
      const bool is_value = types_.contains(id) || module_.constants.contains(id);
      has_any = has_any || (is_value && holds_doubles(type_of(id)));
    }
    return has_any;
  }
  Doubles doubles_of(const Frame& frame, SpirvId id) const {
    const Numbers& words = value(frame, id);
    Doubles made;
    if (!holds_doubles(type_of(id))) {
      for (const std::uint32_t word : words) {
        made.push_back(static_cast<double>(std::bit_cast<float>(word)));
      }
      return made;
    }
    for (std::size_t i = 0; i < words.size(); i += 2) {
      made.push_back(std::bit_cast<double>(std::uint64_t{words[i + 1]} << 32 | words[i]));
    }
    return made;
  }
  static Numbers words_of(const Doubles& of) {
    Numbers words;
    for (const double x : of) {
      const auto bits = std::bit_cast<std::uint64_t>(x);
      words.push_back(static_cast<std::uint32_t>(bits));
      words.push_back(static_cast<std::uint32_t>(bits >> 32));
    }
    return words;
  }
  static Numbers stable_words_of(Doubles of) {
    for (double& x : of) {
      if (std::isnan(x)) x = std::bit_cast<double>(0x7FF80000'00000000u);
    }
    return words_of(of);
  }
  static double dot_of(std::span<const double> a, std::span<const double> b) {
    double sum = a[0] * b[0];
    for (std::size_t i = 1; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
  }
  static std::uint32_t signed_of(double x) {
    return static_cast<std::uint32_t>(x > -0x1p31 - 1.0 && x < 0x1p31 ? static_cast<std::int32_t>(x)
                                                                      : INT32_MIN);
  }

  Numbers of_doubles(Frame& frame, const SpirvInstruction& in, Words w) {
    using enum SpirvOp;
    const Doubles a = in.op == convert_signed_to_float || in.op == convert_unsigned_to_float ||
                              in.op == SpirvOp::select || in.op == bitcast
                          ? Doubles{}
                          : doubles_of(frame, w[0]);
    const auto b = [&](std::size_t i) { return doubles_of(frame, w[1])[i]; };
    const auto each = [&](const auto& function) {
      Doubles made;
      for (std::size_t i = 0; i < a.size(); ++i) made.push_back(function(a[i], i));
      return words_of(made);
    };
    const auto compare = [&](const auto& is) {
      Numbers made;
      for (std::size_t i = 0; i < a.size(); ++i) made.push_back(is(a[i], b(i)) ? ~0u : 0u);
      return made;
    };
    Numbers words;
    Doubles made;
    switch (in.op) {
      case float_negate: return each([](double x, std::size_t) { return -x; });
      case float_add: return each([&](double x, std::size_t i) { return x + b(i); });
      case float_sub: return each([&](double x, std::size_t i) { return x - b(i); });
      case float_mul: return each([&](double x, std::size_t i) { return x * b(i); });
      case float_div: return each([&](double x, std::size_t i) { return x / b(i); });
      case float_mod:
        return each([&](double x, std::size_t i) { return x - b(i) * std::floor(x / b(i)); });
      case vector_times_scalar:
      case matrix_times_scalar: return each([&](double x, std::size_t) { return x * b(0); });
      case float_ord_equal: return compare([](double x, double y) { return x == y; });
      case float_unord_not_equal: return compare([](double x, double y) { return !(x == y); });
      case float_ord_less_than: return compare([](double x, double y) { return x < y; });
      case float_ord_greater_than: return compare([](double x, double y) { return x > y; });
      case float_ord_less_than_equal: return compare([](double x, double y) { return x <= y; });
      case float_ord_greater_than_equal: return compare([](double x, double y) { return x >= y; });
      case is_nan:
        for (const double x : a) words.push_back(std::isnan(x) ? ~0u : 0u);
        return words;
      case is_inf:
        for (const double x : a) words.push_back(std::isinf(x) ? ~0u : 0u);
        return words;
      case float_convert:
        if (holds_doubles(module_.type(in.type))) return words_of(a);
        for (const double x : a) words.push_back(bits_of(static_cast<float>(x)));
        return words;
      case convert_float_to_signed:
        for (const double x : a) words.push_back(signed_of(x));
        return words;
      case convert_float_to_unsigned:
        for (const double x : a) {
          words.push_back(x < 0x1p31 ? signed_of(x) : signed_of(x - 0x1p31) ^ 0x80000000u);
        }
        return words;
      case convert_signed_to_float:
        for (const std::uint32_t x : value(frame, w[0])) {
          made.push_back(std::bit_cast<std::int32_t>(x));
        }
        return words_of(made);
      case convert_unsigned_to_float:
        for (const std::uint32_t x : value(frame, w[0])) made.push_back(x);
        return words_of(made);
      case bitcast:
        return holds_doubles(module_.type(in.type)) ? value(frame, w[0])
                                                    : stable_words_of(doubles_of(frame, w[0]));
      case SpirvOp::select: {
        const Numbers& is = value(frame, w[0]);
        Doubles yes = doubles_of(frame, w[1]);
        for (std::size_t i = 0; i < yes.size(); ++i) {
          if (is[is.size() == 1 ? 0 : i] == 0) yes[i] = doubles_of(frame, w[2])[i];
        }
        return words_of(yes);
      }
      case vector_shuffle: {
        Doubles both = a;
        for (const double x : doubles_of(frame, w[1])) both.push_back(x);
        for (const std::uint32_t i : w.subspan(2)) made.push_back(i == ~0u ? 0.0 : both[i]);
        return words_of(made);
      }
      case vector_extract_dynamic: {
        const auto index = static_cast<std::int32_t>(value(frame, w[1])[0]);
        return words_of({a[static_cast<std::size_t>(
            std::clamp(index, 0, static_cast<std::int32_t>(a.size()) - 1))]});
      }
      case SpirvOp::dot: return words_of({dot_of(a, doubles_of(frame, w[1]))});
      case transpose:
      case matrix_times_vector:
      case matrix_times_matrix: {
        const std::size_t rows = rows_of(w[0]), inner = a.size() / rows;
        Doubles turned;
        for (std::size_t i = 0; i < a.size(); ++i) {
          turned.push_back(a[i % inner * rows + i / inner]);
        }
        if (in.op == transpose) return words_of(turned);
        const Doubles of_b = doubles_of(frame, w[1]);
        for (std::size_t at = 0; at < of_b.size(); at += inner) {
          for (std::size_t row = 0; row < rows; ++row) {
            made.push_back(dot_of(std::span{turned}.subspan(row * inner, inner),
                                  std::span{of_b}.subspan(at, inner)));
          }
        }
        return words_of(made);
      }
      case ext_inst: return glsl_of_doubles(frame, in, w);
      default:
        throw ShaderError("the oracle has no instruction of doubles " +
                          std::to_string(static_cast<int>(in.op)));
    }
  }

  Numbers glsl_of_doubles(Frame& frame, const SpirvInstruction& in, Words w) {
    using enum GlslOp;
    const auto op = static_cast<GlslOp>(in.operands[1]);
    if (op == pack_double_2x32) return value(frame, w[0]);
    Doubles numbers = doubles_of(frame, w[0]);
    if (op == unpack_double_2x32) return stable_words_of(numbers);
    const auto of = [&](std::size_t operand, std::size_t i) {
      return doubles_of(frame, w[operand])[i];
    };
    const auto least = [](double a, double b) { return std::isnan(a) || b < a ? b : a; };
    const auto most = [](double a, double b) { return std::isnan(a) || a < b ? b : a; };
    Numbers words;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      double& x = numbers[i];
      int exponent = 0;
      switch (op) {
        case round:
        case round_even: x = std::nearbyint(x); break;
        case trunc: x = std::trunc(x); break;
        case float_abs: x = std::abs(x); break;
        case float_sign: x = x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : 0.0; break;
        case floor: x = std::floor(x); break;
        case ceil: x = std::ceil(x); break;
        case fract: x = x - std::floor(x); break;
        case sqrt: x = std::sqrt(x); break;
        case inverse_sqrt: x = 1.0 / std::sqrt(x); break;
        case float_min:
        case number_min: x = least(x, of(1, i)); break;
        case float_max:
        case number_max: x = most(x, of(1, i)); break;
        case float_clamp:
        case number_clamp: x = least(most(x, of(1, i)), of(2, i)); break;
        case float_mix: x = x * (1.0 - of(2, i)) + of(1, i) * of(2, i); break;
        case step: x = of(1, i) < x ? 0.0 : 1.0; break;
        case smooth_step: {
          const double t = least(most((of(2, i) - x) / (of(1, i) - x), 0.0), 1.0);
          x = (t * t) * (3.0 - 2.0 * t);
          break;
        }
        case fma: x = x * of(1, i) + of(2, i); break;
        case ldexp: x = std::ldexp(x, static_cast<int>(value(frame, w[1])[i])); break;
        case frexp_struct:
          x = std::frexp(x, &exponent);
          words.push_back(static_cast<std::uint32_t>(exponent));
          break;
        default: break;
      }
    }
    switch (op) {
      case length: return words_of({std::sqrt(dot_of(numbers, numbers))});
      case normalize: {
        const double scale = 1.0 / std::sqrt(dot_of(numbers, numbers));
        for (double& x : numbers) x *= scale;
        return words_of(numbers);
      }
      case cross: {
        const Doubles& a = numbers;
        const Doubles b = doubles_of(frame, w[1]);
        return words_of(
            {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]});
      }
      case GlslOp::determinant:  // of 2x2
        return words_of({numbers[0] * numbers[3] - numbers[1] * numbers[2]});
      case frexp_struct: {
        Numbers all = words_of(numbers);
        all.insert(all.end(), words.begin(), words.end());
        return all;
      }
      default: return words_of(numbers);
    }
  }

  Numbers made(Frame& frame, const SpirvInstruction& in) {
    const Words& w = in.operands;
    const auto of = [&](std::size_t i) -> const Numbers& { return value(frame, w[i]); };
    using enum SpirvOp;
    const Words operands = in.op == ext_inst ? w.subspan(2) : w;
    if (is_of_doubles(in, operands)) return of_doubles(frame, in, operands);
    if (const auto found = each_number().find(in.op); found != each_number().end()) {
      const auto& [op, swaps, turns] = found->second;
      Numbers numbers = of(0);
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        const std::uint32_t b = w.size() > 1 ? of(1)[i] : 0;
        numbers[i] = swaps ? fold(op, b, numbers[i]) : fold(op, numbers[i], b);
        if (turns) numbers[i] = ~numbers[i];
      }
      return numbers;
    }
    switch (in.op) {
      case load: return loaded(pointer(frame, w[0]));
      case function_call: {
        const SpirvFunction& function = module_.functions.at(w[0]);
        std::map<SpirvId, Numbers> values;
        std::map<SpirvId, Pointer> pointers;
        for (std::size_t i = 0; i + 1 < w.size(); ++i) {
          const SpirvInstruction& parameter = function.parameters[i];
          if (module_.type(parameter.type).kind == SpirvKind::pointer) {
            pointers[parameter.result] = pointer(frame, w[i + 1]);
          } else {
            values[parameter.result] = of(i + 1);
          }
        }
        return call(function, values, pointers);
      }
      case ext_inst: return glsl(frame, in);
      case bitcast: {
        const auto kind_of = [&](SpirvId id) {
          const SpirvType& type = module_.type(id);
          return type.kind == SpirvKind::vector ? module_.type(type.element).kind : type.kind;
        };
        const auto constant = module_.constants.find(w[0]);
        const SpirvId from =
            constant == module_.constants.end() ? types_.at(w[0]) : constant->second.type;
        Numbers numbers = of(0);
        if (kind_of(from) != SpirvKind::floating || kind_of(in.type) == SpirvKind::floating) {
          return numbers;
        }
        for (std::uint32_t& x : numbers) {
          if (std::isnan(std::bit_cast<float>(x))) x = 0x7FC00000u;
        }
        return numbers;
      }
      case is_nan: {
        Numbers numbers = of(0);
        for (std::uint32_t& x : numbers) x = fold(To::not_equal, x, x);
        return numbers;
      }
      case float_unord_equal:
      case float_ord_not_equal: {
        Numbers numbers = of(0);
        for (std::size_t i = 0; i < numbers.size(); ++i) {
          const std::uint32_t differs = less(numbers[i], of(1)[i]) | less(of(1)[i], numbers[i]);
          numbers[i] = in.op == float_ord_not_equal ? differs : ~differs;
        }
        return numbers;
      }
      case SpirvOp::select: {
        Numbers numbers = of(1);
        for (std::size_t i = 0; i < numbers.size(); ++i) {
          if (of(0)[of(0).size() == 1 ? 0 : i] == 0) numbers[i] = of(2)[i];
        }
        return numbers;
      }
      case any:
      case all: {
        const bool is_any = in.op == any;
        const bool found = std::any_of(of(0).begin(), of(0).end(),
                                       [&](std::uint32_t x) { return (x != 0) == is_any; });
        return {found == is_any ? ~0u : 0u};
      }
      case composite_construct: {
        Numbers numbers;
        for (const SpirvId id : w) {
          numbers.insert(numbers.end(), value(frame, id).begin(), value(frame, id).end());
        }
        return numbers;
      }
      case composite_extract: {
        SpirvId type = 0;
        const auto constant = module_.constants.find(w[0]);
        type = constant != module_.constants.end() ? constant->second.type : types_.at(w[0]);
        std::uint32_t first = 0;
        for (const std::uint32_t number : w.subspan(1)) first += part(type, number);
        const auto begin = of(0).begin() + first;
        return {begin, begin + module_.type(type).scalars};
      }
      case composite_insert: {
        Numbers numbers = of(1);
        SpirvId type = in.type;
        std::uint32_t first = 0;
        for (const std::uint32_t number : w.subspan(2)) first += part(type, number);
        std::copy(of(0).begin(), of(0).end(), numbers.begin() + first);
        return numbers;
      }
      case vector_shuffle: {
        Numbers both = of(0), numbers;
        both.insert(both.end(), of(1).begin(), of(1).end());
        for (const std::uint32_t i : w.subspan(2)) numbers.push_back(i == ~0u ? 0 : both[i]);
        return numbers;
      }
      case vector_extract_dynamic: {
        const auto last = static_cast<std::int32_t>(of(0).size()) - 1;
        const auto index = static_cast<std::int32_t>(of(1)[0]);
        return {of(0)[static_cast<std::size_t>(std::clamp(index, 0, last))]};
      }
      case vector_insert_dynamic: {
        Numbers numbers = of(0);
        const auto last = static_cast<std::int32_t>(numbers.size()) - 1;
        const auto index = static_cast<std::int32_t>(of(2)[0]);
        numbers[static_cast<std::size_t>(std::clamp(index, 0, last))] = of(1)[0];
        return numbers;
      }
      case vector_times_scalar:
      case matrix_times_scalar: {
        Numbers numbers = of(0);
        for (std::uint32_t& x : numbers) x = times(x, of(1)[0]);
        return numbers;
      }
      case SpirvOp::dot: return {spirv::dot(of(0), of(1))};
      case transpose: return transposed(of(0), rows_of(w[0]));
      case outer_product: {
        Numbers numbers;
        for (const std::uint32_t column : of(1)) {
          for (const std::uint32_t row : of(0)) numbers.push_back(times(row, column));
        }
        return numbers;
      }
      case vector_times_matrix: {
        Numbers numbers;
        const std::size_t rows = of(0).size();
        for (std::size_t at = 0; at < of(1).size(); at += rows) {
          numbers.push_back(spirv::dot(of(0), Words{of(1)}.subspan(at, rows)));
        }
        return numbers;
      }
      case matrix_times_vector:
      case matrix_times_matrix: {
        const std::size_t rows = rows_of(w[0]), inner = of(0).size() / rows;
        const Numbers turned = transposed(of(0), rows);  // row after row
        Numbers numbers;
        for (std::size_t at = 0; at < of(1).size(); at += inner) {
          for (std::size_t row = 0; row < rows; ++row) {
            numbers.push_back(spirv::dot(Words{turned}.subspan(row * inner, inner),
                                         Words{of(1)}.subspan(at, inner)));
          }
        }
        return numbers;
      }
      case integer_add_carry:
      case integer_sub_borrow:
      case unsigned_mul_extended:
      case signed_mul_extended: {
        Numbers low, high;
        for (std::size_t i = 0; i < of(0).size(); ++i) {
          const std::uint32_t a = of(0)[i], b = of(1)[i];
          if (in.op == integer_add_carry) {
            low.push_back(a + b);
            high.push_back(a + b < a ? 1 : 0);
          } else if (in.op == integer_sub_borrow) {
            low.push_back(a - b);
            high.push_back(a < b ? 1 : 0);
          } else {
            low.push_back(a * b);
            high.push_back(fold(in.op == signed_mul_extended ? To::multiply_high_signed
                                                             : To::multiply_high_unsigned,
                                a, b));
          }
        }
        low.insert(low.end(), high.begin(), high.end());
        return low;
      }
      case bit_field_s_extract:
      case bit_field_u_extract: {
        Numbers numbers = of(0);
        for (std::uint32_t& x : numbers) {
          x = fold(
              in.op == bit_field_s_extract ? To::extract_bits_signed : To::extract_bits_unsigned, x,
              of(1)[0], of(2)[0]);
        }
        return numbers;
      }
      case bit_field_insert: {
        Numbers numbers = of(0);
        const std::uint32_t first = of(2)[0], count = of(3)[0];
        const std::uint32_t ones = fold(To::extract_bits_unsigned, ~0u, 0, count);
        const std::uint32_t field = fold(To::shift_left, ones, first);
        for (std::size_t i = 0; i < numbers.size(); ++i) {
          numbers[i] = (numbers[i] & ~field) | (fold(To::shift_left, of(1)[i], first) & field);
        }
        return numbers;
      }
      case sampled_image: return {of(0)[0], of(1)[0]};
      case image: return {of(0)[0]};
      case image_fetch: return fetched(of(0)[0], of(1), w.size() > 3 ? of(3)[0] : 0);
      case image_query_size:
      case image_query_size_lod: {
        const Image& level = settings_.textures[of(0)[0]].texture->levels.front();
        return {static_cast<std::uint32_t>(level.width), static_cast<std::uint32_t>(level.height)};
      }
      default:
        throw ShaderError("the oracle has no instruction " +
                          std::to_string(static_cast<int>(in.op)));
    }
  }

  std::size_t rows_of(SpirvId matrix) const { return module_.type(type_of(matrix).element).count; }
  /// Of a matrix in columns of `rows` numbers its rows, one after the other.
  static Numbers transposed(const Numbers& m, std::size_t rows) {
    Numbers made;
    for (std::size_t row = 0; row < rows; ++row) {
      for (std::size_t at = row; at < m.size(); at += rows) made.push_back(m[at]);
    }
    return made;
  }

  Numbers fetched(std::uint32_t texture, const Numbers& at, std::uint32_t level) const {
    const std::vector<Image>& levels = settings_.textures[texture].texture->levels;
    if (level >= levels.size()) return {0, 0, 0, 0};
    const Image& image = levels[level];
    if (at[0] >= static_cast<std::uint32_t>(image.width) ||
        at[1] >= static_cast<std::uint32_t>(image.height)) {
      return {0, 0, 0, 0};
    }
    const glm::vec4 texel =
        fetch_texel(image, static_cast<int>(at[0]), static_cast<int>(at[1]), settings_.profile);
    return {bits_of(texel.x), bits_of(texel.y), bits_of(texel.z), bits_of(texel.w)};
  }

  Numbers glsl(Frame& frame, const SpirvInstruction& in) {
    const auto op = static_cast<GlslOp>(in.operands[1]);
    const Words w = in.operands.subspan(2);
    const auto of = [&](std::size_t i) -> const Numbers& { return value(frame, w[i]); };
    const std::uint32_t zero = bits_of(0.0f), one = bits_of(1.0f), two = bits_of(2.0f);
    Numbers numbers = of(0);
    using enum GlslOp;
    if (const auto found = each_of_glsl().find(op); found != each_of_glsl().end()) {
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        numbers[i] = fold(found->second, numbers[i], w.size() > 1 ? of(1)[i] : 0,
                          w.size() > 2 ? of(2)[i] : 0);
      }
      return numbers;
    }
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      std::uint32_t& x = numbers[i];
      switch (op) {
        case radians: x = times(x, bits_of(std::numbers::pi_v<float> / 180.0f)); break;
        case degrees: x = times(x, bits_of(180.0f / std::numbers::pi_v<float>)); break;
        case float_clamp: x = clamped(x, of(1)[i], of(2)[i]); break;
        case number_min: x = of_numbers(To::minimum, x, of(1)[i]); break;
        case number_max: x = of_numbers(To::maximum, x, of(1)[i]); break;
        case number_clamp:
          x = of_numbers(To::minimum, of_numbers(To::maximum, x, of(1)[i]), of(2)[i]);
          break;
        case unsigned_clamp:
          x = fold(To::minimum_unsigned, fold(To::maximum_unsigned, x, of(1)[i]), of(2)[i]);
          break;
        case signed_clamp:
          x = fold(To::minimum_signed, fold(To::maximum_signed, x, of(1)[i]), of(2)[i]);
          break;
        case float_mix: x = plus(times(x, minus(one, of(2)[i])), times(of(1)[i], of(2)[i])); break;
        case step: x = less(of(1)[i], x) != 0 ? zero : one; break;
        case smooth_step: {
          const std::uint32_t t =
              clamped(fold(To::divide, minus(of(2)[i], x), minus(of(1)[i], x)), zero, one);
          x = times(times(t, t), minus(bits_of(3.0f), times(two, t)));
          break;
        }
        default: break;
      }
    }
    switch (op) {
      case modf:
      case frexp:
      case modf_struct:
      case frexp_struct: {
        const bool is_modf = op == modf || op == modf_struct;
        Numbers first = of(0), second = of(0);
        for (std::uint32_t& x : second) x = fold(is_modf ? To::truncate : To::exponent_of, x);
        for (std::size_t i = 0; i < first.size(); ++i) {
          first[i] = is_modf ? minus(first[i], second[i]) : fold(To::mantissa_of, first[i]);
        }
        if (op == modf || op == frexp) {
          store(pointer(frame, w[1]), second);
        } else {
          first.insert(first.end(), second.begin(), second.end());
        }
        return first;
      }
      case length: return {fold(To::square_root, spirv::dot(of(0), of(0)))};
      case distance: {
        for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = minus(of(0)[i], of(1)[i]);
        return {fold(To::square_root, spirv::dot(numbers, numbers))};
      }
      case normalize: {
        const std::uint32_t scale = fold(To::inverse_square_root, spirv::dot(of(0), of(0)));
        for (std::uint32_t& x : numbers) x = times(x, scale);
        return numbers;
      }
      case cross: {
        const Numbers &a = of(0), &b = of(1);
        return {minus(times(a[1], b[2]), times(a[2], b[1])),
                minus(times(a[2], b[0]), times(a[0], b[2])),
                minus(times(a[0], b[1]), times(a[1], b[0]))};
      }
      case face_forward: {
        const bool keeps = less(spirv::dot(of(2), of(1)), zero) != 0;
        for (std::uint32_t& x : numbers) x = keeps ? x : fold(To::negate, x);
        return numbers;
      }
      case reflect: {
        const std::uint32_t twice = times(two, spirv::dot(of(1), of(0)));
        for (std::size_t i = 0; i < numbers.size(); ++i) {
          numbers[i] = minus(numbers[i], times(twice, of(1)[i]));
        }
        return numbers;
      }
      case refract: {
        const std::uint32_t eta = of(2)[0], cosine = spirv::dot(of(1), of(0));
        const std::uint32_t k =
            minus(one, times(times(eta, eta), minus(one, times(cosine, cosine))));
        const std::uint32_t along = plus(times(eta, cosine), fold(To::square_root, k));
        for (std::size_t i = 0; i < numbers.size(); ++i) {
          numbers[i] =
              less(k, zero) != 0 ? zero : minus(times(eta, numbers[i]), times(along, of(1)[i]));
        }
        return numbers;
      }
      case GlslOp::determinant: return {spirv::determinant(numbers, rows_of(w[0]))};
      case matrix_inverse: {
        const std::size_t n = rows_of(w[0]);
        const std::uint32_t all = spirv::determinant(numbers, n);
        Numbers inverse;
        for (std::size_t column = 0; column < n; ++column) {
          for (std::size_t row = 0; row < n; ++row) {
            std::uint32_t minor = spirv::determinant(minor_of(numbers, n, row, column), n - 1);
            if ((column + row) % 2 == 1) minor = fold(To::negate, minor);
            inverse.push_back(fold(To::divide, minor, all));
          }
        }
        return inverse;
      }
      case pack_half_2x16:
        return {fold(To::to_half, numbers[0]) | fold(To::to_half, numbers[1]) << 16};
      case unpack_half_2x16:
        return {fold(To::from_half, numbers[0] & 0xFFFF), fold(To::from_half, numbers[0] >> 16)};
      default: return numbers;
    }
  }
};

}  // namespace spirv

/// Needs a valid module without derivatives.
inline OracleResult run_oracle(const SpirvModule& module, const OracleSettings& settings) {
  return spirv::Oracle{module, settings}.run();
}

}  // namespace softfocus::test

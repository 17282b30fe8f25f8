#pragma once
// A shader between SPIR-V and what runs: a tree of scalar instructions.
//
// Functions are inlined, vectors and matrices are scalars, constants are known. Values are made
// once; what changes is a variable. A region is a list of nodes that run one after the other. Nodes
// that steer are three:
//
//   branch   one of two regions, by a boolean
//   scope    a region that an exit may leave, or that runs again and again until one does
//   exit     leaves a scope, and those inside it
//
// `return` leaves the scope of its function, `break` that of a loop or switch, `continue` the scope
// that a loop's body is. So lanes that are elsewhere need a mask, and nothing else.

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "raster/images/sampler.h"
#include "raster/shaders/spirv_module.h"

namespace softfocus {

/// A value: a number of 32 bits a lane. Booleans are all bits or none; a double is two values.
using ShaderValue = std::uint32_t;
inline constexpr ShaderValue kNoValue = 0xFFFFFFFF;
using ShaderVariable = std::uint32_t;

enum class ShaderOp : std::uint8_t {
  // Of floats.
  add,
  subtract,
  multiply,
  divide,
  negate,
  absolute,
  minimum,
  maximum,
  floor,
  ceiling,
  truncate,
  round_even,
  fraction,
  sign,
  square_root,
  fused_multiply_add,
  remainder,
  modulo,
  // Functions of math_lanes.inl.
  inverse_square_root,
  sine,
  cosine,
  tangent,
  arc_sine,
  arc_cosine,
  arc_tangent,
  arc_tangent_2,
  hyperbolic_sine,
  hyperbolic_cosine,
  hyperbolic_tangent,
  area_sine,
  area_cosine,
  area_tangent,
  exponential,
  logarithm,
  exponential_2,
  logarithm_2,
  power,
  scale_by_exponent,
  mantissa_of,
  exponent_of,
  // Of integers.
  add_integers,
  subtract_integers,
  multiply_integers,
  negate_integer,
  absolute_integer,
  sign_integer,
  divide_unsigned,
  divide_signed,
  modulo_unsigned,
  remainder_signed,
  modulo_signed,
  multiply_high_unsigned,
  multiply_high_signed,
  minimum_signed,
  maximum_signed,
  minimum_unsigned,
  maximum_unsigned,
  shift_left,
  shift_right,
  shift_right_signed,
  bit_and,
  bit_or,
  bit_xor,
  bit_not,
  count_bits,
  reverse_bits,
  lowest_bit,
  highest_bit_signed,
  highest_bit_unsigned,
  extract_bits_signed,
  extract_bits_unsigned,
  // Comparisons, which give booleans; with NaN only `not_equal` is true.
  equal,
  not_equal,
  less,
  less_equal,
  equal_integers,
  less_signed,
  less_equal_signed,
  less_unsigned,
  less_equal_unsigned,
  is_infinite,
  // Choice and conversion.
  select,
  to_signed,
  to_unsigned,
  from_signed,
  from_unsigned,
  to_half,
  from_half,
  // Of doubles: a and b are the low and the high word of the first, c and d of the second. Those
  // that give a double are two, for its low word and for its high word.
  add_doubles,
  add_doubles_high,
  subtract_doubles,
  subtract_doubles_high,
  multiply_doubles,
  multiply_doubles_high,
  divide_doubles,
  divide_doubles_high,
  square_root_of_double,
  square_root_of_double_high,
  floor_of_double,
  floor_of_double_high,
  round_even_double,
  round_even_double_high,
  mantissa_of_double,
  mantissa_of_double_high,
  scale_double,  ///< by the exponent c
  scale_double_high,
  double_of_float,
  double_of_float_high,
  double_of_signed,
  double_of_signed_high,
  float_of_double,
  signed_of_double,
  exponent_of_double,
  equal_doubles,
  less_doubles,
  less_equal_doubles,
  // Differences to the next pixel of the 2x2 block.
  derivative_x,
  derivative_y,
  derivative_x_coarse,
  derivative_y_coarse,
  // Memory.
  load,
  store,  ///< of a variable
  load_indexed,
  store_indexed,  ///< of variables in a row, clamped to them
  load_constant,  ///< of a table, clamped likewise
  // What the pixel is given, and textures.
  input,
  sample,
  kill,  ///< of the pixel, which is not stored
  copy,
};

enum class SampleKind : std::uint8_t {
  fetch,      ///< a texel by whole numbers
  implicit,   ///< level by differences between pixels, and a bias
  level,      ///< level given
  gradient,   ///< level by differences given
  gather,     ///< one channel of four texels
  size,       ///< of a level
  levels,     ///< how many
  query_lod,  ///< the level that `implicit` would take
};

/// The shape of the textures that an image type reads.
inline TextureShape texture_shape(const SpirvType& image) {
  if (image.dim == SpirvDim::cube) return TextureShape::cube;
  if (image.dim == SpirvDim::three) return TextureShape::volume;
  return image.is_arrayed ? TextureShape::array : TextureShape::flat;
}

/// What a sampling instruction reads and makes.
struct ShaderSample {
  SampleKind kind{};
  SpirvDim dim = SpirvDim::two;
  TextureShape shape = TextureShape::flat;
  bool is_shadow = false;
  bool is_integer = false;  ///< the texture's numbers are bits
  int channel = 0;          ///< of a gather
  ShaderValue texture = kNoValue, sampler = kNoValue;
  /// Places or whole numbers, a layer behind them; bias, level or differences; what is compared.
  std::array<ShaderValue, 4> at{kNoValue, kNoValue, kNoValue, kNoValue};
  std::array<ShaderValue, 6> more{kNoValue, kNoValue, kNoValue, kNoValue, kNoValue, kNoValue};
  ShaderValue compared = kNoValue;
  std::array<ShaderValue, 3> offset{kNoValue, kNoValue, kNoValue};
  std::array<ShaderValue, 4> to{kNoValue, kNoValue, kNoValue, kNoValue};
};

struct ShaderInstruction {
  ShaderOp op{};
  ShaderValue to = kNoValue;
  ShaderValue a = kNoValue, b = kNoValue, c = kNoValue, d = kNoValue;
  /// A variable; the first of variables or of a table's numbers; an input; a sample.
  std::uint32_t place = 0;
  std::uint32_t count = 0;   ///< of places that an index chooses from
  std::uint32_t stride = 1;  ///< from one to the next
  ShaderLine line{};
};

/// Whether its operands or results are words of doubles.
constexpr bool is_of_doubles(ShaderOp op) {
  return op >= ShaderOp::add_doubles && op <= ShaderOp::less_equal_doubles;
}

struct ShaderNode;
using ShaderRegion = std::vector<ShaderNode>;

enum class ShaderNodeKind : std::uint8_t { instruction, branch, scope, exit };

struct ShaderNode {
  ShaderNodeKind kind = ShaderNodeKind::instruction;
  ShaderInstruction instruction{};  ///< of a branch: `a` is its condition
  std::uint32_t scope = 0;          ///< of a scope or exit
  bool loops = false;               ///< of a scope
  /// Of a branch where the condition holds and where not; of a scope the first.
  std::unique_ptr<ShaderRegion> first{}, second{};
};

/// What a pixel or vertex is given.
struct ShaderInput {
  int builtin = -1;                 ///< a SpirvBuiltin, or:
  int location = 0, component = 0;  ///< of a varying
  int part = 0;                     ///< of a builtin's vector
  bool is_flat = false, is_linear = false;
  bool is_whole = false;  ///< an integer
  int uniform = -1;       ///< a word of the uniforms, if it is known only when the shader runs
};

/// Where a result comes to lie when the shader ends.
struct ShaderOutput {
  int builtin = -1;
  int location = 0, component = 0;
  ShaderVariable variable = 0;
  bool is_integer = false;
};

struct ShaderTree {
  ShaderRegion main{};
  /// Of each value, whether its bits are known, and they.
  struct Known {
    bool is_known = false;
    std::uint32_t bits = 0;
  };
  std::vector<Known> values{};
  std::unordered_map<std::uint32_t, ShaderValue> constant_of{};
  std::uint32_t variable_count = 0;
  std::uint32_t scope_count = 0;
  std::vector<std::uint32_t> tables{};  ///< numbers that load_constant reads
  std::vector<ShaderSample> samples{};
  std::vector<ShaderInput> inputs{};
  std::vector<ShaderOutput> outputs{};
  bool has_derivatives = false;

  ShaderValue constant(std::uint32_t bits) {
    const auto [at, is_new] =
        constant_of.try_emplace(bits, static_cast<ShaderValue>(values.size()));
    if (is_new) values.push_back({true, bits});
    return at->second;
  }
  ShaderValue new_value() {
    values.push_back({});
    return static_cast<ShaderValue>(values.size() - 1);
  }
  bool is_constant(ShaderValue value) const { return values[value].is_known; }
  std::uint32_t bits(ShaderValue value) const { return values[value].bits; }
};

}  // namespace softfocus

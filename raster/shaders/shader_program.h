#pragma once
// A shader as it runs: steps over registers, each a number a lane. What does not vary from pixel to
// pixel has a register of one number, and its steps run once.

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "raster/shaders/shader_ir.h"

namespace softfocus {

/// What a step does: a ShaderOp, or one of these behind them.
enum class StepOp : std::uint8_t {
  and_not = static_cast<std::uint8_t>(ShaderOp::copy) + 1,  ///< a and not b
  masked_copy,                                              ///< where b: a
  multiply_add,                                             ///< a b + c, each rounded
  jump,                                                     ///< to `place`
  jump_if_none,   ///< if no lane of a is set; with a count, steps run from now on over the vectors
                  ///< from the first that has one to the last, in groups of four
  jump_if_false,  ///< a does not vary
  check_budget,   ///< each time a loop begins anew
  keep_range,     ///< of lanes that steps run over, in `to`, which does not vary
  widen_range,    ///< to that in a
  end,
};

/// A register: the number of one that varies, or of one that does not.
struct ShaderRegister {
  std::uint32_t number = 0;
  bool varies = false;
  bool is_there = false;
};

struct ShaderStep {
  std::uint8_t op = 0;
  ShaderRegister to{}, a{}, b{}, c{}, d{};
  std::uint32_t place = 0;  ///< of a jump its target; of a table its begin; of a sample its number
  std::uint32_t count = 0, stride = 1;  ///< of an index
  ShaderLine line{};
};

struct ShaderSampleRegisters {
  ShaderSample sample{};
  ShaderRegister texture{}, sampler{}, compared{};
  std::array<ShaderRegister, 4> at{};
  std::array<ShaderRegister, 6> more{};
  std::array<ShaderRegister, 3> offset{};
  std::array<ShaderRegister, 4> to{};
};

struct ShaderProgram {
  std::vector<ShaderStep> steps{};
  std::uint32_t varying_count = 0, uniform_count = 0;  ///< registers
  struct Constant {
    std::uint32_t number = 0, bits = 0;  ///< a register that does not vary
  };
  std::vector<Constant> constants{};
  struct Input {
    ShaderInput input{};
    ShaderRegister to{};
  };
  std::vector<Input> inputs{};
  struct Output {
    ShaderOutput output{};
    ShaderRegister from{};
  };
  std::vector<Output> outputs{};
  std::vector<ShaderSampleRegisters> samples{};
  std::vector<std::uint32_t> tables{};
  ShaderRegister killed{};  ///< if any pixel may be
  bool has_derivatives = false;
  std::map<SpirvId, std::string> files{};  ///< that lines are of
};

constexpr std::uint8_t number_of(ShaderOp op) { return static_cast<std::uint8_t>(op); }
constexpr std::uint8_t number_of(StepOp op) { return static_cast<std::uint8_t>(op); }

ShaderProgram emit_program(const ShaderTree& tree);

// What emit_program() ends with.

/// Registers that must lie one behind the other: an index chooses from them.
struct RegisterRow {
  std::uint32_t first = 0, length = 0;
};

/// A product and a sum become one step, a value and its copy one register.
void join_steps(ShaderProgram& program);

/// Values that vary share registers if they are not there at the same time.
void share_registers(ShaderProgram& program, std::span<const RegisterRow> rows);

}  // namespace softfocus

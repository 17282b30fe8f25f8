#pragma once
// Numbers of a pipeline that depend on the lens, the picture and parameters: "ceil(max_coc_px) -
// 1".

#include <cstdint>
#include <span>
#include <vector>

namespace softfocus {

enum class ExpressionOp : std::uint8_t {
  number,
  value,
  negate,
  add,
  subtract,
  multiply,
  divide,
  remainder,  ///< a - b floor(a / b)
  floor,
  ceil,
  abs,
  sqrt,
  min,
  max,
  sin_degrees,
  cos_degrees,
  exp2,
};

/// Steps over a stack, in the order in which they run. Each rounds once, to binary64.
struct Expression {
  struct Step {
    ExpressionOp op = ExpressionOp::number;
    double number = 0.0;
    std::uint32_t value = 0;
  };
  std::vector<Step> steps{};
};

Expression constant_expression(double number);

/// `values` in the order of the names.
double evaluate(const Expression& expression, std::span<const double> values);

}  // namespace softfocus

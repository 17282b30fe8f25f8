#include "dof/pipelines/expression.h"

#include <cmath>

#include "raster/numbers/exact_math.h"

namespace softfocus {

Expression constant_expression(double number) { return {{{.number = number}}}; }

double evaluate(const Expression& expression, std::span<const double> values) {
  std::vector<double> stack;
  stack.reserve(expression.steps.size());
  const auto pop = [&] {
    const double top = stack.back();
    stack.pop_back();
    return top;
  };
  for (const Expression::Step& step : expression.steps) {
    switch (step.op) {
      case ExpressionOp::number: stack.push_back(step.number); continue;
      case ExpressionOp::value: stack.push_back(values[step.value]); continue;
      default: break;
    }
    const double b = pop();
    switch (step.op) {
      case ExpressionOp::negate: stack.push_back(-b); break;
      case ExpressionOp::floor: stack.push_back(std::floor(b)); break;
      case ExpressionOp::ceil: stack.push_back(std::ceil(b)); break;
      case ExpressionOp::abs: stack.push_back(std::fabs(b)); break;
      case ExpressionOp::sqrt: stack.push_back(std::sqrt(b)); break;
      case ExpressionOp::sin_degrees: stack.push_back(exact_math::sin_degrees(b)); break;
      case ExpressionOp::cos_degrees: stack.push_back(exact_math::cos_degrees(b)); break;
      case ExpressionOp::exp2: stack.push_back(exact_math::exp2(b)); break;
      default: {
        const double a = pop();
        stack.push_back(step.op == ExpressionOp::add        ? a + b
                        : step.op == ExpressionOp::subtract ? a - b
                        : step.op == ExpressionOp::multiply ? a * b
                        : step.op == ExpressionOp::divide   ? a / b
                        : step.op == ExpressionOp::min      ? (b < a ? b : a)
                        : step.op == ExpressionOp::max      ? (a < b ? b : a)
                                                            : a - b * std::floor(a / b));
      }
    }
  }
  return stack.back();
}

}  // namespace softfocus

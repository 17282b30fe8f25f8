#pragma once
// The text of an expression (dof/pipelines/expression.h).

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "dof/pipelines/expression.h"

namespace softfocus {

struct ExpressionError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Numbers, names of values, + - * / %, parentheses and the functions above. Throws
/// ExpressionError: what is wrong, and what would be right.
Expression parse_expression(std::string_view text, std::span<const std::string> names);

}  // namespace softfocus

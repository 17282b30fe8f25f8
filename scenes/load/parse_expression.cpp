#include "scenes/load/parse_expression.h"

#include <algorithm>
#include <array>
#include <optional>

#include "scenes/files/decimal.h"

namespace softfocus {
namespace {

struct ExpressionFunction {
  std::string_view name;
  ExpressionOp op;
  int arguments;
};

constexpr std::array kExpressionFunctions{
    ExpressionFunction{"floor", ExpressionOp::floor, 1},
    ExpressionFunction{"ceil", ExpressionOp::ceil, 1},
    ExpressionFunction{"abs", ExpressionOp::abs, 1},
    ExpressionFunction{"sqrt", ExpressionOp::sqrt, 1},
    ExpressionFunction{"min", ExpressionOp::min, 2},
    ExpressionFunction{"max", ExpressionOp::max, 2},
    ExpressionFunction{"sin_degrees", ExpressionOp::sin_degrees, 1},
    ExpressionFunction{"cos_degrees", ExpressionOp::cos_degrees, 1},
    ExpressionFunction{"exp2", ExpressionOp::exp2, 1}};

constexpr int kDeepestExpression = 64;

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || (c >= '0' && c <= '9');
}

class ExpressionParser {
 public:
  ExpressionParser(std::string_view text, std::span<const std::string> names)
      : text_(text), names_(names) {}

  Expression parse() {
    sum();
    if (peek() != '\0') fail("'" + std::string{text_.substr(at_)} + "' is left over");
    return std::move(made_);
  }

 private:
  std::string_view text_;
  std::span<const std::string> names_;
  std::size_t at_ = 0;
  int depth_ = 0;
  Expression made_{};

  [[noreturn]] void fail(const std::string& why) const {
    throw ExpressionError("'" + std::string{text_} + "': " + why);
  }

  char peek() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  bool take(char wanted) {
    if (peek() != wanted) return false;
    ++at_;
    return true;
  }
  void expect(char wanted) {
    if (!take(wanted)) fail("a '" + std::string{wanted} + "' is missing");
  }
  void add(ExpressionOp op) { made_.steps.push_back({.op = op}); }

  void sum() {
    product();
    for (;;) {
      const bool is_sum = take('+');
      if (!is_sum && !take('-')) return;
      product();
      add(is_sum ? ExpressionOp::add : ExpressionOp::subtract);
    }
  }

  void product() {
    factor();
    for (;;) {
      const char sign = peek();
      if (sign != '*' && sign != '/' && sign != '%') return;
      ++at_;
      factor();
      add(sign == '*'   ? ExpressionOp::multiply
          : sign == '/' ? ExpressionOp::divide
                        : ExpressionOp::remainder);
    }
  }

  void factor() {
    if (++depth_ > kDeepestExpression) fail("it is nested too deeply");
    if (take('-')) {
      factor();
      add(ExpressionOp::negate);
    } else if (take('(')) {
      sum();
      expect(')');
    } else if (const char c = peek(); (c >= '0' && c <= '9') || c == '.') {
      number();
    } else {
      named();
    }
    --depth_;
  }

  // Digits, a point and digits; an exponent.
  void number() {
    const std::size_t begin = at_;
    const auto digits = [&] {
      while (at_ < text_.size() && text_[at_] >= '0' && text_[at_] <= '9') ++at_;
    };
    digits();
    if (at_ < text_.size() && text_[at_] == '.') ++at_;
    digits();
    if (at_ < text_.size() && (text_[at_] == 'e' || text_[at_] == 'E')) {
      ++at_;
      if (at_ < text_.size() && (text_[at_] == '-' || text_[at_] == '+')) ++at_;
      digits();
    }
    const std::string_view word = text_.substr(begin, at_ - begin);
    const std::optional<double> value = decimal_to_double(word);
    if (!value) fail("'" + std::string{word} + "' is no number");
    made_.steps.push_back({.number = *value});
  }

  void named() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && is_letter(text_[at_])) ++at_;
    const std::string_view name = text_.substr(begin, at_ - begin);
    if (name.empty()) {
      fail(at_ < text_.size() ? "'" + std::string{text_.substr(at_, 1)} + "' is not known"
                              : "a number or a name is missing");
    }
    if (take('(')) {
      const auto function =
          std::find_if(kExpressionFunctions.begin(), kExpressionFunctions.end(),
                       [&](const ExpressionFunction& of) { return of.name == name; });
      if (function == kExpressionFunctions.end()) {
        std::string known;
        for (const ExpressionFunction& of : kExpressionFunctions) {
          if (!known.empty()) known += ", ";
          known += of.name;
        }
        fail("there is no function '" + std::string{name} + "'; there are " + known);
      }
      for (int i = 0; i < function->arguments; ++i) {
        if (i > 0) expect(',');
        sum();
      }
      expect(')');
      return add(function->op);
    }
    const auto value = std::find(names_.begin(), names_.end(), name);
    if (value == names_.end()) {
      std::string known;
      for (const std::string& of : names_) {
        if (!known.empty()) known += ", ";
        known += of;
      }
      fail("there is no '" + std::string{name} + "'; there are " + known);
    }
    made_.steps.push_back(
        {.op = ExpressionOp::value, .value = static_cast<std::uint32_t>(value - names_.begin())});
  }
};

}  // namespace

Expression parse_expression(std::string_view text, std::span<const std::string> names) {
  return ExpressionParser{text, names}.parse();
}

}  // namespace softfocus

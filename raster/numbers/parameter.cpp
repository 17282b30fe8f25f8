#include "raster/numbers/parameter_text.h"

#include <cmath>
#include <cstdio>

namespace softfocus {
namespace {

constexpr double kNearlyNothing = 1e-9;  // the least of what is above 0

bool is_above_zero(const Parameter& parameter) {
  return parameter.least > 0.0 && parameter.least <= kNearlyNothing;
}

}  // namespace

bool is_allowed(const Parameter& parameter, double value) {
  if (!(value >= parameter.least && value <= parameter.most)) return false;
  return parameter.step == 0 || std::fmod(value - parameter.least, parameter.step) == 0.0;
}

std::string plain_number(double value) {
  constexpr double kLongest = 1e7;
  char text[32];
  const bool is_whole = std::fabs(value) < kLongest && value == std::floor(value);
  std::snprintf(text, sizeof text, is_whole ? "%.0f" : "%.6g", value);
  std::string number{text};
  for (const char* sign : {"e+0", "e+"}) {  // 1e9, not 1e+09
    const std::size_t at = number.find(sign);
    if (at != number.npos) number.replace(at, std::string_view{sign}.size(), "e");
  }
  return number;
}

std::string range_text(const Parameter& parameter) {
  const std::string most = plain_number(parameter.most);
  if (is_above_zero(parameter)) return "above 0, up to " + most;
  return plain_number(parameter.least) + " to " + most;
}

std::string wanted_text(const Parameter& parameter) {
  const std::string kind = parameter.step == 0   ? "a number "
                           : parameter.step == 1 ? "a whole number "
                                                 : "an odd number ";
  return kind + (is_above_zero(parameter) ? "" : "from ") + range_text(parameter) +
         (parameter.unit.empty() ? "" : " (" + std::string{parameter.unit} + ")");
}

}  // namespace softfocus

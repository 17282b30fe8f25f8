#include "tools/options/lengths.h"

#include <array>
#include <limits>

#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"

namespace softfocus {
namespace {

/// A unit is `mm_over` / `mm_under` millimetres: quotients of whole numbers, so that 250cm is 2.5.
struct LengthUnit {
  std::string_view name;
  double mm_over, mm_under;
};
constexpr std::array kUnits{LengthUnit{"mm", 1.0, 1.0}, LengthUnit{"cm", 10.0, 1.0},
                            LengthUnit{"ft", 3048.0, 10.0}, LengthUnit{"in", 254.0, 10.0},
                            LengthUnit{"m", 1000.0, 1.0}};

double parse_length(std::string_view option, const std::string& text, double mm_of_base,
                    double least, double most, std::string_view wanted) {
  for (const LengthUnit& unit : kUnits) {
    if (!text.ends_with(unit.name)) continue;
    constexpr double kMost = std::numeric_limits<double>::max();
    double value = 0.0;
    try {
      value = parse_number(option, text.substr(0, text.size() - unit.name.size()), -kMost, kMost,
                           wanted);
    } catch (const UsageError&) {  // which knows the number alone
      return parse_number(option, text, least, most, wanted);
    }
    const double length = unit.mm_over >= mm_of_base * unit.mm_under
                              ? value * (unit.mm_over / mm_of_base) / unit.mm_under
                              : value / (mm_of_base * unit.mm_under / unit.mm_over);
    if (length >= least && length <= most) return length;
    return parse_number(option, text, least, most, wanted);  // which refuses it
  }
  return parse_number(option, text, least, most, wanted);
}

}  // namespace

double parse_metres(std::string_view option, const std::string& text, double least, double most,
                    std::string_view wanted) {
  return parse_length(option, text, 1000.0, least, most, wanted);
}

double parse_millimetres(std::string_view option, const std::string& text, double least,
                         double most, std::string_view wanted) {
  return parse_length(option, text, 1.0, least, most, wanted);
}

double parse_f_number(std::string_view option, const std::string& text, double least, double most,
                      std::string_view wanted) {
  const std::size_t start = text.starts_with("f/") ? 2 : text.starts_with('f') ? 1 : 0;
  try {
    return parse_number(option, text.substr(start), least, most, wanted);
  } catch (const UsageError&) {  // which knows the number alone
    throw UsageError(std::string{option} + " '" + text + "': give " + std::string{wanted});
  }
}

}  // namespace softfocus

#include "tools/compare/tolerance.h"

#include <cmath>

#include "tools/cli/option_values.h"

namespace softfocus {

bool has_limits(const Tolerance& tolerance) {
  return tolerance.max_half_ulps || tolerance.max_flip || tolerance.max_error;
}

std::vector<LimitFinding> check_limits(const Tolerance& tolerance, const Difference& difference,
                                       std::optional<double> flip) {
  std::vector<LimitFinding> findings;
  if (tolerance.max_half_ulps) {
    findings.push_back({"--max-ulps", " half-ULPs", static_cast<double>(*tolerance.max_half_ulps),
                        static_cast<double>(difference.max_ulp)});
  }
  if (tolerance.max_flip) findings.push_back({"--max-flip", "", *tolerance.max_flip, flip.value()});
  if (tolerance.max_error) {
    findings.push_back({"--max-error", "", *tolerance.max_error, difference.max_error});
  }
  return findings;
}

std::string limit_text(const LimitFinding& finding) {
  const auto text = [](double value) {
    return std::isinf(value) ? std::string{"infinity"} : short_number(value);
  };
  const std::string away = text(std::fabs(finding.value - finding.limit));
  return finding.option + " " + short_number(finding.limit) + ": " +
         (is_kept(finding) ? "kept, " + away + " below" : "broken by " + away) + ", at " +
         text(finding.value) + finding.unit;
}

}  // namespace softfocus

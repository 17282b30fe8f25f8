#include <algorithm>
#include <cmath>

#include "tools/stress/cases/stress_case.h"

namespace softfocus {

std::vector<StressCase> stress_cases() {
  std::vector<StressCase> all;
  for (const auto cases :
       {edge_cases(), light_cases(), crowd_cases(), glass_cases(), plane_cases(), depth_cases(),
        plain_cases(), motion_cases(), shutter_cases(), shadow_cases(), relief_cases()}) {
    all.insert(all.end(), cases.begin(), cases.end());
  }
  return all;
}

double shown_severity(const StressCase& of, std::span<const double> severities) {
  return *std::min_element(severities.begin(), severities.end(), [&](double a, double b) {
    return std::fabs(a - of.telling) < std::fabs(b - of.telling);
  });
}

std::vector<double> severities_of(const StressCase& of, int size_px, bool quick) {
  std::vector<double> fitting;
  for (const double severity : of.severities) {
    if (of.parameter.unit != "px" || severity <= size_px / 4.0) fitting.push_back(severity);
  }
  if (!quick) return fitting;
  std::vector<double> some{fitting.front(), shown_severity(of, fitting), fitting.back()};
  some.erase(std::unique(some.begin(), some.end()), some.end());
  return some;
}

bool same_trials(const StressCase& a, const StressCase& b) {
  return a.make == b.make && a.views == b.views && a.telling == b.telling &&
         std::equal(a.severities.begin(), a.severities.end(), b.severities.begin(),
                    b.severities.end());
}

}  // namespace softfocus

#include "tools/stress/stress_report.h"

#include <algorithm>
#include <cmath>

#include "tools/cli/option_values.h"

namespace softfocus {
namespace {

template <class Take>
void for_each_value(const StressFindings& findings, const Take& take) {
  for (const StressResult& result : findings.results) {
    for (const StressCurve& curve : result.curves) {
      for (std::size_t i = 0; i < curve.values.size(); ++i) {
        take(result, curve, result.severities[i], curve.values[i]);
      }
    }
  }
}

}  // namespace

Json stress_json(const StressFindings& findings) {
  Json list = Json::array();
  for_each_value(findings, [&](const StressResult& result, const StressCurve& curve,
                               double severity, double value) {
    Json parameter{{"name", result.of.parameter.name}};
    parameter["value"] = severity;
    parameter["unit"] = result.of.parameter.unit;
    Json entry{{"method", curve.method}};
    entry["case"] = result.of.name;
    entry["parameter"] = std::move(parameter);
    entry["value"] = number_or_null(value);
    entry["unit"] = result.of.unit;
    entry["limit"] = result.of.limit;
    entry["holds"] = holds(result.of, value);
    list.push_back(std::move(entry));
  });
  return list;
}

std::string stress_csv(const StressFindings& findings) {
  std::string text =
      "method,case,parameter,parameter_value,parameter_unit,value,unit,limit,holds\n";
  for_each_value(findings, [&](const StressResult& result, const StressCurve& curve,
                               double severity, double value) {
    const StressCase& of = result.of;
    text += curve.method + "," + std::string{of.name} + "," + std::string{of.parameter.name} + "," +
            json_text(Json(severity)) + "," + std::string{of.parameter.unit} + "," +
            (std::isfinite(value) ? json_text(Json(value)) : "") + "," + std::string{of.unit} +
            "," + json_text(Json(of.limit)) + "," + (holds(of, value) ? "true" : "false") + "\n";
  });
  return text;
}

std::string failing_text(const StressResult& result, const StressCurve& curve) {
  const auto first = first_failure(result, curve);
  if (!first) return "holds";
  std::size_t last = curve.values.size() - 1;
  while (holds(result.of, curve.values[last])) --last;
  const bool to_the_end = last == curve.values.size() - 1;
  const bool all_fail = std::none_of(curve.values.begin(), curve.values.end(),
                                     [&](double value) { return holds(result.of, value); });
  if (all_fail) return "all";
  const std::string from = short_number(result.severities[*first]);
  if (to_the_end) return "from " + from;
  if (last == *first) return "at " + from;
  if (*first == 0) return "up to " + short_number(result.severities[last]);
  return from + " to " + short_number(result.severities[last]);
}

std::string stress_summary(const StressFindings& findings) {
  std::string text;
  const std::size_t methods = findings.results.empty() ? 0 : findings.results[0].curves.size();
  for (std::size_t m = 0; m < methods; ++m) {
    int all = 0, held = 0;
    std::string failing;
    for (const StressResult& result : findings.results) {
      const StressCurve& curve = result.curves[m];
      if (!curve.can_run) continue;
      ++all;
      if (!first_failure(result, curve)) {
        ++held;
        continue;
      }
      failing += (failing.empty() ? "; fails " : ", ") + std::string{result.of.name} + " (" +
                 failing_text(result, curve) + ")";
    }
    text += findings.results[0].curves[m].method + ": holds " + std::to_string(held) + " of " +
            std::to_string(all) + failing + "\n";
  }
  return text;
}

}  // namespace softfocus

#pragma once
// The findings as JSON, as a table, in words, and as a report (tools/report/report.h).

#include <string>

#include "tools/files/json.h"
#include "tools/stress/findings.h"

namespace softfocus {

/// [{method, case, parameter: {name, value, unit}, value, unit, limit, holds}]: one a method that
/// can run, a case and a severity. A value that is not finite is null.
Json stress_json(const StressFindings& findings);

/// That list with the columns parameter, parameter_value and parameter_unit.
std::string stress_csv(const Json& list);

/// A line a method: how many cases hold throughout, and from where on the others do not.
std::string stress_summary(const StressFindings& findings);

/// "holds", "all", or from the mildest failure to the most severe one, between which some may hold:
/// "from 8", "up to 8", "8 to 16", "at 8".
std::string failing_text(const StressResult& result, const StressCurve& curve);

/// The table, case by method, coloured by the worst value over the limit; and for each case its
/// curves, its truth, and each method's picture and error.
Json stress_report(const StressFindings& findings, const StressOptions& options);

/// The worst value of a curve over the limit; infinity where a value is not finite, or where a
/// limit of 0 does not hold.
double worst_ratio(const StressResult& result, const StressCurve& curve);

}  // namespace softfocus

#pragma once
// The findings as JSON, as a table, and in words.

#include <string>

#include "tools/files/json.h"
#include "tools/stress/findings.h"

namespace softfocus {

/// [{method, case, parameter: {name, value, unit}, value, unit, limit, holds}]: one a method that
/// can run, a case and a severity. A value that is not finite is null.
Json stress_json(const StressFindings& findings);

/// The same, with the columns parameter, parameter_value and parameter_unit.
std::string stress_csv(const StressFindings& findings);

/// A line a method: how many cases hold throughout, and from where on the others do not.
std::string stress_summary(const StressFindings& findings);

/// "holds", "all", or from the mildest failure to the most severe one, between which some may hold:
/// "from 8", "up to 8", "8 to 16", "at 8".
std::string failing_text(const StressResult& result, const StressCurve& curve);

}  // namespace softfocus

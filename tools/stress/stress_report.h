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

/// "from 8", "8 to 16" where the most severe hold again, "all" or "holds".
std::string failing_text(const StressResult& result, const StressCurve& curve);

}  // namespace softfocus

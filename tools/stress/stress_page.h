#pragma once
// The atlas as a report (tools/report/report.h).

#include "tools/files/json.h"
#include "tools/stress/findings.h"

namespace softfocus {

/// The table, case by method, coloured by the worst value over the limit; and for each case its
/// curves, its truth, and each method's picture and error.
Json stress_report(const StressFindings& findings, const StressOptions& options);

/// The worst value of a curve over the limit; infinity where a value is not finite, or where a
/// limit of 0 does not hold.
double worst_ratio(const StressResult& result, const StressCurve& curve);

}  // namespace softfocus

#pragma once
// The atlas as one page of HTML that needs no other file.

#include <string>

#include "tools/stress/findings.h"

namespace softfocus {

/// The table, case by method, coloured by the worst value over the limit; and for each case its
/// truth, and for each method its curve, picture and error.
std::string stress_page(const StressFindings& findings, const StressOptions& options);

/// The worst value of a curve over the limit; infinity where a value is not finite, or where a
/// limit of 0 does not hold.
double worst_ratio(const StressResult& result, const StressCurve& curve);

}  // namespace softfocus

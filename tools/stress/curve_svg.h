#pragma once
// Curves of a case as SVG inside a page: severity to the right, the measured number upwards.

#include <string>

#include "tools/stress/findings.h"

namespace softfocus {

/// All methods' curves of a case, axes and limit, to be used by curve_svg(): an element that
/// shows nothing by itself. Both axes are logarithmic where the values allow it; the upper one
/// ends at 30 times the limit and a 30th of it, and values beyond lie on its border.
std::string curve_backdrop(const StressResult& result);

/// The curve of one method before that backdrop.
std::string curve_svg(const StressResult& result, const StressCurve& curve);

}  // namespace softfocus

#pragma once
// How the page names a contender's point, and leads to its pictures.

#include <string>

#include "tools/chart/point.h"

namespace softfocus {

/// The point's place in the page.
std::string element_id(const ChartPanel& panel, const ChartPoint& point);

/// The method's name, leading to the point's pictures if it has some.
std::string method_link(const ChartPanel& panel, const ChartPoint& point);

/// "two-pass, max-coc 16".
std::string full_name(const ChartPoint& point);

}  // namespace softfocus

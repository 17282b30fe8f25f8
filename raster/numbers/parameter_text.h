#pragma once
// A parameter in words, for help, errors and tables. Apart from parameter.h, which headers of the
// library include: <string> doubles what a compiler reads of them.

#include <string>

#include "raster/numbers/parameter.h"

namespace softfocus {

/// "0 to 1", "above 0, up to 1e9".
std::string range_text(const Parameter& parameter);

/// What would be right: "a whole number from 1 to 4096 (points)".
std::string wanted_text(const Parameter& parameter);

/// "0.25", "1000000", "1e9".
std::string plain_number(double value);

}  // namespace softfocus

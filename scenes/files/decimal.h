#pragma once
// Numbers from text, the same on every machine and whatever the locale.

#include <optional>
#include <string_view>

namespace softfocus {

/// The nearest float or double to a decimal, to infinity or to NaN ("inf", "nan"), or nothing if
/// `word` is anything else. Too large gives infinity.
std::optional<float> decimal_to_float(std::string_view word);
std::optional<double> decimal_to_double(std::string_view word);

}  // namespace softfocus

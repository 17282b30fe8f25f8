#pragma once
// Lengths and f-numbers as photographers write them: 2.5m, 250cm, 50mm, 8ft, 6in, f/1.8.

#include <string>
#include <string_view>

namespace softfocus {

/// A length in metres or millimetres, from `least` to `most` in that unit. A number without a unit
/// is in it. Throws UsageError as parse_number() does.
double parse_metres(std::string_view option, const std::string& text, double least, double most,
                    std::string_view wanted);
double parse_millimetres(std::string_view option, const std::string& text, double least,
                         double most, std::string_view wanted);

/// "1.8", "f/1.8" or "f1.8" likewise.
double parse_f_number(std::string_view option, const std::string& text, double least, double most,
                      std::string_view wanted);

}  // namespace softfocus

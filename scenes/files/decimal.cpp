#include "scenes/files/decimal.h"

#include <charconv>
#include <cstdlib>
#include <string>
#include <type_traits>

namespace softfocus {
namespace {

template <class Number>
std::optional<Number> nearest(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
#if defined(__cpp_lib_to_chars)
  Number value{0};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || error == std::errc::invalid_argument) return {};
  if (error != std::errc::result_out_of_range) return value;
#else
  // What strtof takes and from_chars does not: hexadecimal, blanks and a second plus.
  if (word.find_first_of("xX \t\n\v\f\r") != word.npos || word.starts_with('+')) return {};
#endif
  // from_chars does not say whether it was too large or too small, strtof does.
  const std::string copy(word);
  char* after = nullptr;
  Number rounded{0};
  if constexpr (std::is_same_v<Number, float>) {
    rounded = std::strtof(copy.c_str(), &after);
  } else {
    rounded = std::strtod(copy.c_str(), &after);
  }
  if (word.empty() || after != copy.c_str() + copy.size()) return {};
  return rounded;
}

}  // namespace

std::optional<float> decimal_to_float(std::string_view word) { return nearest<float>(word); }

std::optional<double> decimal_to_double(std::string_view word) { return nearest<double>(word); }

}  // namespace softfocus

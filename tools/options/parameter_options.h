#pragma once
// Options made of parameters and choices (raster/numbers/parameter.h), and what several options
// have in common: KEY=VALUE lists, and that one excludes another.

#include <functional>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "raster/numbers/parameter_text.h"
#include "tools/cli/option_values.h"
#include "tools/cli/parser.h"

namespace softfocus {

/// Throws UsageError: the option, what was given, what would be right. Lengths may have a unit, as
/// in 2.5m, 250cm, 50mm, 8ft and 6in; an f-number may begin with f/ or f.
double parse_parameter(std::string_view option, const std::string& text,
                       const Parameter& parameter);

/// "SUMMARY, ALSO (RANGE; default: STANDARD)".
std::string help_of(const Parameter& parameter, const std::string& also,
                    const std::string& standard);

/// Adds --NAME. `standard` says in the help what counts without it; empty: nothing to say.
void add_parameter(CLI::App& parser, const Parameter& parameter, const std::string& standard,
                   std::function<void(double)> take);
template <class Value>
void add_parameter(CLI::App& parser, const Parameter& parameter, const std::string& standard,
                   Value& place) {
  add_parameter(parser, parameter, standard,
                [&place](double value) { place = static_cast<Value>(value); });
}
/// The parameter's own preset counts.
template <class Value>
void add_parameter(CLI::App& parser, const Parameter& parameter, Value& place) {
  add_parameter(parser, parameter, plain_number(parameter.preset), place);
}

/// Adds an option whose value is one of some names.
void add_choice(CLI::App& parser, const std::string& option, const std::string& help,
                const std::vector<std::string>& names, std::function<void(std::size_t)> take);
/// `choices` are constants.
template <class Choices, class Value>
void add_choice(CLI::App& parser, const std::string& option, const std::string& help,
                const Choices& choices, Value& place) {
  add_choice(parser, option, help, names_in(choices),
             [&choices, &place](std::size_t number) { place = choices[number].value; });
}

/// Calls take(number of the key, value) for each of "KEY=VALUE,...". Throws UsageError, which
/// begins with `where`, for another key, and for one that comes twice.
void read_pairs(const std::string& where, std::string_view text,
                const std::vector<std::string>& keys,
                const std::function<void(std::size_t key, const std::string& value)>& take);

/// Throws UsageError if one of the options was given: "OPTION: why".
void refuse_given(const CLI::App& parser, std::initializer_list<const char*> options,
                  const std::string& why);

/// Throws UsageError if two of the options were given.
void check_one_of(const CLI::App& parser, std::initializer_list<const char*> options);

}  // namespace softfocus

#include "tools/options/parameter_options.h"

#include <algorithm>
#include <array>
#include <limits>

#include "scenes/files/scene_error.h"
#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"

namespace softfocus {
namespace {

/// A unit is `mm_over` / `mm_under` millimetres: quotients of whole numbers, so that 250cm is 2.5.
struct LengthUnit {
  std::string_view name;
  double mm_over, mm_under;
};
constexpr std::array kUnits{LengthUnit{"mm", 1.0, 1.0}, LengthUnit{"cm", 10.0, 1.0},
                            LengthUnit{"ft", 3048.0, 10.0}, LengthUnit{"in", 254.0, 10.0},
                            LengthUnit{"m", 1000.0, 1.0}};

/// The value in millimetres or, if `mm_of_base` is 1000, metres.
double in_base(double value, const LengthUnit& unit, double mm_of_base) {
  return unit.mm_over >= mm_of_base * unit.mm_under
             ? value * (unit.mm_over / mm_of_base) / unit.mm_under
             : value / (mm_of_base * unit.mm_under / unit.mm_over);
}

/// Throws UsageError for what is no number.
double any_number(const std::string& text) {
  constexpr double kMost = std::numeric_limits<double>::max();
  return parse_number("", text, -kMost, kMost, "");
}

double with_unit(const std::string& text, const Parameter& parameter) {
  if (parameter.name == "f-number") {
    return any_number(text.substr(text.starts_with("f/") ? 2 : text.starts_with('f') ? 1 : 0));
  }
  const bool is_metres = parameter.unit == "m";
  if (is_metres || parameter.unit == "mm") {
    for (const LengthUnit& unit : kUnits) {
      if (!text.ends_with(unit.name)) continue;
      return in_base(any_number(text.substr(0, text.size() - unit.name.size())), unit,
                     is_metres ? 1000.0 : 1.0);
    }
  }
  return any_number(text);
}

}  // namespace

double parse_parameter(std::string_view option, const std::string& text,
                       const Parameter& parameter) {
  try {
    const double value = with_unit(text, parameter);
    if (is_allowed(parameter, value)) return value;
  } catch (const UsageError&) {  // which knows the number alone
  }
  const bool is_length = parameter.unit == "m" || parameter.unit == "mm";
  throw UsageError(std::string{option} + " '" + text + "': give " + wanted_text(parameter) +
                   (is_length ? ", or with its unit, such as 250cm"
                    : parameter.name == "f-number"
                        ? "; for an all-sharp picture take --method pinhole"
                        : ""));
}

std::string help_of(const Parameter& parameter, const std::string& also,
                    const std::string& standard) {
  return std::string{parameter.summary} + also + " (" + range_text(parameter) +
         (standard.empty() ? "" : "; default: " + standard) + ")";
}

void add_parameter(CLI::App& parser, const Parameter& parameter, const std::string& standard,
                   std::function<void(double)> take) {
  const std::string option = "--" + std::string{parameter.name};
  add_value(parser, option, std::string{parameter.type}, help_of(parameter, "", standard),
            [parameter, option, take = std::move(take)](const std::string& text) {
              take(parse_parameter(option, text, parameter));
            });
}

void add_choice(CLI::App& parser, const std::string& option, const std::string& help,
                const std::vector<std::string>& names, std::function<void(std::size_t)> take) {
  std::string type;
  for (const std::string& name : names) type += (type.empty() ? "" : "|") + name;
  add_value(parser, option, type, help,
            [option, names, take = std::move(take)](const std::string& text) {
              const auto found = std::find(names.begin(), names.end(), text);
              if (found == names.end()) refuse_name(option, text, names);
              take(static_cast<std::size_t>(found - names.begin()));
            });
}

namespace {

[[noreturn]] void refuse_part(const std::string& where, const std::string& part,
                              const std::vector<std::string>& keys) {
  const std::size_t equals = part.find('=');
  if (equals == part.npos) {
    std::string list;
    for (const std::string& known : keys) {
      list.append(list.empty() ? "there are " : ", ").append(known);
    }
    throw UsageError(where + ": '" + part + "' is no key=value; " +
                     (list.empty() ? "it takes none" : list) + did_you_mean(part, keys));
  }
  if (keys.empty()) throw UsageError(where + ": '" + part + "': it takes none");
  refuse_name(where + ": the key", part.substr(0, equals), keys);
}

[[noreturn]] void refuse_twice(const std::string& where, const std::string& key) {
  throw UsageError(where + ": " + key + " is there twice; give it once");
}

}  // namespace

void read_pairs(const std::string& where, std::string_view text,
                const std::vector<std::string>& keys,
                const std::function<void(std::size_t key, const std::string& value)>& take) {
  std::vector<bool> given(keys.size());
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string part{text.substr(begin, end - begin)};
    const std::size_t equals = std::min(part.find('='), part.size());
    const std::string key = part.substr(0, equals);
    const auto found = std::find(keys.begin(), keys.end(), key);
    if (found == keys.end() || equals == part.size()) {
      refuse_part(where, part, keys);
    }
    const auto number = static_cast<std::size_t>(found - keys.begin());
    if (given[number]) refuse_twice(where, key);
    given[number] = true;
    take(number, part.substr(equals + 1));
    begin = end + 1;
  }
}

void refuse_given(const CLI::App& parser, std::initializer_list<const char*> options,
                  const std::string& why) {
  for (const char* option : options) {
    if (is_given(parser, option)) throw UsageError(std::string{option} + ": " + why);
  }
}

void check_one_of(const CLI::App& parser, std::initializer_list<const char*> options) {
  const char* first = nullptr;
  for (const char* option : options) {
    if (!is_given(parser, option)) continue;
    if (first != nullptr) {
      throw UsageError(std::string{first} + " and " + option + " exclude each other; give one");
    }
    first = option;
  }
}

}  // namespace softfocus

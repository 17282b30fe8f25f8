#pragma once
// What can be set, stated once. Options and their help, keys of scene files, controls of the page,
// checks of the C interface and tables of the documentation are made of it.

#include <string_view>

namespace softfocus {

/// A setting that is a number, from `least` to `most`, both included.
struct Parameter {
  std::string_view name;  ///< of an option, without its dashes; of an effect's key
  std::string_view summary;
  double least, most;
  double preset;
  std::string_view unit = {};  ///< "mm"
  std::string_view type = {};  ///< stands for the value in the help, "MM"
  std::string_view key = {};   ///< of scene files and requests, if it is not the name
  int step = 0;  ///< 1: whole numbers; 2: every other one, from `least` on; 0: any number
};

/// A word that stands for a value.
template <class Value>
struct Choice {
  std::string_view name;
  Value value;
};

/// The word of a value that is among them.
template <class Choices, class Value>
constexpr std::string_view word_for(const Choices& choices, const Value& value) {
  for (const auto& choice : choices) {
    if (choice.value == value) return choice.name;
  }
  return {};
}

/// NaN is not.
bool is_allowed(const Parameter& parameter, double value);

inline std::string_view key_of(const Parameter& parameter) {
  return parameter.key.empty() ? parameter.name : parameter.key;
}

}  // namespace softfocus

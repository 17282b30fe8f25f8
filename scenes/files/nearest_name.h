#pragma once
// Of the names that there are, the one that was probably meant.

#include <span>
#include <string>
#include <string_view>

namespace softfocus {

/// How many letters to insert, drop or replace, or neighbours to swap, to get from one name to the
/// other: the optimal string alignment distance (Damerau 1964).
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The end of a message about a name that there is not: "; did you mean 'figures'?", or nothing if
/// no name is near: an edit for three letters, at most three, or the beginning of a longer name.
std::string did_you_mean(std::string_view mistyped, std::span<const std::string> names);

}  // namespace softfocus

#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace softfocus {

/// The text with '?' for what a terminal or a reader could be deceived by, for names in files may
/// hold it: control characters (C0, C1), separators of lines, marks and overrides of the direction
/// of writing, and bytes that are not UTF-8.
std::string printable(std::string_view text);

/// A fault in a file. The message is one line that names the file, the line in it, and what
/// would be right.
struct SceneError : std::runtime_error {
  explicit SceneError(const std::string& message) : std::runtime_error(printable(message)) {}
};

// Of the names that there are, the one that was probably meant.

/// How many letters to insert, drop or replace, or neighbours to swap, to get from one name to the
/// other: the optimal string alignment distance (Damerau 1964).
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The end of a message about a name that there is not: "; did you mean 'figures'?", or nothing if
/// no name is near: an edit for three letters, at most three, or the beginning of a longer name.
std::string did_you_mean(std::string_view mistyped, std::span<const std::string> names);

}  // namespace softfocus

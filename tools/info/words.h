#pragma once
// The field's words, for `softfocus help WORD`: what each is, in a sentence, and where it is here.

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace softfocus {

struct Word {
  std::string_view names;  ///< its names, the first is the usual one, by ", "
  std::string_view meaning;
  /// By ", ": commands ("softfocus lens"), their options ("softfocus render --method two-pass"),
  /// pages ("docs/lens.md").
  std::string_view places;
};

std::span<const Word> words();

/// The words with that name. If there is none: those in whose name a word begins with it. Capitals,
/// hyphens and a plural's s make no difference.
std::vector<Word> find_words(std::string_view name);

/// A word for a terminal of so many columns.
std::string text_of(const Word& word, int columns);

}  // namespace softfocus

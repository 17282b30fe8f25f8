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

/// The words with that name; if there is none, those of which a name has it as a part. Capitals,
/// hyphens and an s at the end make no difference.
std::vector<Word> find_words(std::string_view name);

/// A word for a terminal of so many columns.
std::string text_of(const Word& word, int columns);

}  // namespace softfocus

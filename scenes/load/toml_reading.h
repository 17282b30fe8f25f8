#pragma once
// Checked reading of TOML tables: every value has a type and a range, every key is
// known, and every complaint names the file, the line, the key and what would be right.

// toml++ 3.3 asserts what only the file decides: a `[` at a line's end would end the
// program. Without its assertions it goes on to a proper error.
#define TOML_ASSERT(expr) static_assert(true)
#include <toml++/toml.h>

#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace softfocus {

/// A table that is being read. The readers below note which keys they were asked for;
/// finish_section complains about the others.
struct Section {
  const toml::table* table = nullptr;  ///< nullptr: not in the file, all defaults
  std::string file;
  std::string name;  ///< as complaints name it, say `material.red`; empty at the top
  std::vector<std::string> known_keys;
};

/// Both ends belong to it.
struct Range {
  double low;
  double high;
};

/// What a length, a place or a size in metres may be.
inline constexpr Range kAnyPlace{-1e6, 1e6};
inline constexpr Range kAnySize{1e-6, 1e6};

/// Throws SceneError `file:line: name.key: what is wrong; what would be right`, with
/// the key's line, or the section's where the key is missing.
[[noreturn]] void fail_at(const Section& section, std::string_view key, const std::string& reason);

/// The node of a key, noted as known, or nullptr.
const toml::node* find_key(Section& section, std::string_view key);
bool has_key(Section& section, std::string_view key);

/// Each returns `fallback` where the key is missing, and throws SceneError where the
/// value has another type, is NaN or infinite or lies outside the range.
double read_number(Section& section, std::string_view key, double fallback, Range range);
int read_whole_number(Section& section, std::string_view key, int fallback, int low, int high);
bool read_flag(Section& section, std::string_view key, bool fallback);
std::string read_text(Section& section, std::string_view key, std::string_view fallback);
/// An array of three numbers.
glm::dvec3 read_vector(Section& section, std::string_view key, glm::dvec3 fallback, Range range);
/// An array of `count` numbers, `count` = 0 for any number of them.
std::vector<double> read_numbers(Section& section, std::string_view key,
                                 const std::vector<double>& fallback, std::size_t count,
                                 Range range);
/// An array of arrays of `length` numbers each; empty where the key is missing.
std::vector<std::vector<double>> read_rows(Section& section, std::string_view key,
                                           std::size_t length, Range range);
/// An array of texts; empty where the key is missing.
std::vector<std::string> read_texts(Section& section, std::string_view key);
/// The place in `choices` of the key's text.
std::size_t read_choice(Section& section, std::string_view key, std::size_t fallback,
                        std::span<const std::string_view> choices);

/// The table of a key such as [lens]; an empty section where there is none.
Section read_section(Section& parent, std::string_view key);
/// The tables of a key such as [[light]].
std::vector<Section> read_sections(Section& parent, std::string_view key);
/// The tables in the table of a key, such as [material.red] and [material.blue] for
/// `material`, in the file's order, each with its own name.
struct NamedSection {
  std::string name;
  Section section;
};
std::vector<NamedSection> read_named_sections(Section& parent, std::string_view key);

/// Throws SceneError for the first key that no reader asked for, and names those that
/// one did.
void finish_section(const Section& section);

/// `a, b and c`.
std::string list_words(std::span<const std::string> words);

}  // namespace softfocus

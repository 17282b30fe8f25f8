#include "scenes/load/toml_reading.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <sstream>

#include "raster/numbers/parameter_text.h"
#include "scenes/files/scene_error.h"

namespace softfocus {
namespace {

std::string dotted(const Section& section, std::string_view key) {
  if (section.name.empty()) return std::string(key);
  return key.empty() ? section.name : section.name + "." + std::string(key);
}

[[noreturn]] void fail_at_line(const Section& section, toml::source_index line,
                               std::string_view key, const std::string& reason) {
  std::ostringstream message;
  message << section.file << ':' << std::max<toml::source_index>(line, 1) << ": "
          << dotted(section, key) << ": " << reason;
  throw SceneError(message.str());
}

std::string in_words(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

std::string in_words(Range range) {
  return "from " + in_words(range.low) + " to " + in_words(range.high);
}

std::string kind_of(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table: return "a table";
    case toml::node_type::array: return "an array";
    case toml::node_type::string: return "a text";
    case toml::node_type::integer:
    case toml::node_type::floating_point: return "a number";
    case toml::node_type::boolean: return "true or false";
    default: return "a date or time";
  }
}

[[noreturn]] void fail_type(const Section& section, std::string_view key, const toml::node& node,
                            const std::string& wanted) {
  fail_at_line(section, node.source().begin.line, key,
               "is " + kind_of(node) + "; " + wanted + " would be right");
}

double number_of(const Section& section, std::string_view key, const toml::node& node, Range range,
                 const std::string& wanted) {
  if (!node.is_number()) fail_type(section, key, node, wanted);
  // value<double>() has none for whole numbers past 2^53.
  const double value = node.is_integer() ? static_cast<double>(node.as_integer()->get())
                                         : node.as_floating_point()->get();
  if (!(value >= range.low && value <= range.high)) {  // NaN is outside
    fail_at_line(section, node.source().begin.line, key,
                 in_words(value) + " is out of range; " + wanted + " would be right");
  }
  return value;
}

std::string number_in(Range range) { return "a number " + in_words(range); }

std::vector<double> numbers_of(const Section& section, std::string_view key, const toml::node& node,
                               std::size_t count, Range range) {
  const std::string how_many = count == 0 ? "" : std::to_string(count) + " ";
  const std::string wanted = "an array of " + how_many + "numbers " + in_words(range);
  const toml::array* array = node.as_array();
  if (array == nullptr) fail_type(section, key, node, wanted);
  if (count != 0 && array->size() != count) {
    fail_at_line(section, node.source().begin.line, key,
                 "has " + std::to_string(array->size()) + " values; " + wanted + " would be right");
  }
  std::vector<double> numbers;
  for (const toml::node& value : *array) {
    numbers.push_back(number_of(section, key, value, range, wanted));
  }
  return numbers;
}

/// A key in American spelling, "color" of "colour"; empty if it has no other.
std::string american(std::string_view key) {
  constexpr std::string_view kColour = "colour", kColor = "color";
  const auto at = key.find(kColour);
  if (at == key.npos) return {};
  return std::string(key).replace(at, kColour.size(), kColor);
}

/// The node of a key in either spelling, or nullptr.
const toml::node* node_of(const Section& section, std::string_view key) {
  if (section.table == nullptr) return nullptr;
  const toml::node* node = section.table->get(key);
  return node != nullptr ? node : section.table->get(american(key));
}

/// The end of the string that begins at `at`, or of the text.
std::size_t string_end(std::string_view text, std::size_t at) {
  const char quote = text[at];
  const std::string_view mark =
      text.substr(at, text.substr(at).starts_with(std::string(3, quote)) ? 3 : 1);
  for (std::size_t i = at + mark.size(); i < text.size(); ++i) {
    if (quote == '"' && text[i] == '\\') {
      ++i;
    } else if (text.substr(i).starts_with(mark) || (mark.size() == 1 && text[i] == '\n')) {
      return i + mark.size();
    }
  }
  return text.size();
}

/// The line of a key of too many parts, or 0.
int line_of_long_key(std::string_view text) {
  int line = 1;
  int parts = 1;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char letter = text[i];
    if (letter == '"' || letter == '\'') {
      const std::size_t end = string_end(text, i);
      line += static_cast<int>(std::count(text.begin() + static_cast<std::ptrdiff_t>(i),
                                          text.begin() + static_cast<std::ptrdiff_t>(end), '\n'));
      i = end - 1;
    } else if (letter == '.') {
      if (++parts > kMostKeyParts) return line;
    } else if (letter == '#') {
      i = std::min(text.find('\n', i), text.size()) - 1;
    } else if (std::string_view{"=,[]{}\n"}.find(letter) != std::string_view::npos) {
      parts = 1;
      if (letter == '\n') ++line;
    }
  }
  return 0;
}

}  // namespace

toml::table parse_toml(std::string_view text, const std::string& file, std::string_view reference) {
  if (const int line = line_of_long_key(text)) {
    throw SceneError(file + ":" + std::to_string(line) + ": a key has more than " +
                     std::to_string(kMostKeyParts) + " parts; fewer would be right");
  }
  try {
    return toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    throw SceneError(file + ":" + std::to_string(error.source().begin.line) +
                     ": is no TOML: " + std::string(error.description()) +
                     "; see https://toml.io and " + std::string(reference));
  }
}

void fail_at(const Section& section, std::string_view key, const std::string& reason) {
  toml::source_index line = 0;
  if (section.table != nullptr) {
    const toml::node* node = node_of(section, key);
    line = (node != nullptr ? node->source() : section.table->source()).begin.line;
  }
  fail_at_line(section, line, key, reason);
}

const toml::node* find_key(Section& section, std::string_view key) {
  auto& known = section.known_keys;
  if (std::find(known.begin(), known.end(), key) != known.end()) return node_of(section, key);
  known.emplace_back(key);
  const std::string other = american(key);
  if (section.table == nullptr || !section.table->contains(other)) return node_of(section, key);
  if (section.table->contains(key)) {
    fail_at(section, other, "is there as " + std::string(key) + " too; one of them would be right");
  }
  known.push_back(other);
  return section.table->get(other);
}

bool has_key(Section& section, std::string_view key) { return find_key(section, key) != nullptr; }

double read_number(Section& section, std::string_view key, double fallback, Range range) {
  const toml::node* node = find_key(section, key);
  return node != nullptr ? number_of(section, key, *node, range, number_in(range)) : fallback;
}

double read_number(Section& section, const Parameter& parameter, double fallback) {
  const std::string_view key = key_of(parameter);
  const toml::node* node = find_key(section, key);
  if (node == nullptr) return fallback;
  const std::string wanted = wanted_text(parameter);
  const double value = number_of(section, key, *node, {parameter.least, parameter.most}, wanted);
  if (parameter.step != 0 && !is_allowed(parameter, value)) {
    fail_at(section, key, in_words(value) + " is out of range; " + wanted + " would be right");
  }
  return value;
}

int read_whole_number(Section& section, std::string_view key, int fallback, int low, int high) {
  const toml::node* node = find_key(section, key);
  if (node == nullptr) return fallback;
  const std::string wanted =
      "a whole number from " + std::to_string(low) + " to " + std::to_string(high);
  if (node->is_floating_point())
    fail_at(section, key, "has a fraction; " + wanted + " would be right");
  if (!node->is_integer()) fail_type(section, key, *node, wanted);
  const std::int64_t value = *node->value<std::int64_t>();
  if (value < low || value > high) {
    fail_at(section, key,
            std::to_string(value) + " is out of range; " + wanted + " would be right");
  }
  return static_cast<int>(value);
}

bool read_flag(Section& section, std::string_view key, bool fallback) {
  const toml::node* node = find_key(section, key);
  if (node == nullptr) return fallback;
  if (!node->is_boolean()) fail_type(section, key, *node, "true or false");
  return *node->value<bool>();
}

std::string read_text(Section& section, std::string_view key, std::string_view fallback) {
  const toml::node* node = find_key(section, key);
  if (node == nullptr) return std::string(fallback);
  if (!node->is_string()) fail_type(section, key, *node, "a text in quotes");
  return *node->value<std::string>();
}

glm::dvec3 read_vector(Section& section, std::string_view key, glm::dvec3 fallback, Range range) {
  const toml::node* node = find_key(section, key);
  if (node == nullptr) return fallback;
  const std::vector<double> numbers = numbers_of(section, key, *node, 3, range);
  return {numbers[0], numbers[1], numbers[2]};
}

std::vector<double> read_numbers(Section& section, std::string_view key,
                                 const std::vector<double>& fallback, std::size_t count,
                                 Range range) {
  const toml::node* node = find_key(section, key);
  return node != nullptr ? numbers_of(section, key, *node, count, range) : fallback;
}

std::vector<std::vector<double>> read_rows(Section& section, std::string_view key,
                                           std::size_t length, Range range) {
  std::vector<std::vector<double>> rows;
  const toml::node* node = find_key(section, key);
  if (node == nullptr) return rows;
  const toml::array* array = node->as_array();
  if (array == nullptr) {
    fail_type(section, key, *node, "an array of arrays of " + std::to_string(length) + " numbers");
  }
  for (const toml::node& entry : *array) {
    rows.push_back(numbers_of(section, key, entry, length, range));
  }
  return rows;
}

std::vector<std::string> read_texts(Section& section, std::string_view key) {
  std::vector<std::string> texts;
  const toml::node* node = find_key(section, key);
  if (node == nullptr) return texts;
  const toml::array* array = node->as_array();
  if (array == nullptr) fail_type(section, key, *node, "an array of texts");
  for (const toml::node& entry : *array) {
    if (!entry.is_string()) fail_type(section, key, entry, "an array of texts");
    texts.push_back(*entry.value<std::string>());
  }
  return texts;
}

std::size_t read_choice(Section& section, std::string_view key, std::size_t fallback,
                        std::span<const std::string_view> choices) {
  if (!has_key(section, key)) return fallback;
  const std::string text = read_text(section, key, "");
  const auto found = std::find(choices.begin(), choices.end(), text);
  if (found == choices.end()) {
    const std::vector<std::string> words(choices.begin(), choices.end());
    fail_at(
        section, key,
        "there is no \"" + text + "\"; there are " + list_words(words) + did_you_mean(text, words));
  }
  return static_cast<std::size_t>(found - choices.begin());
}

Section read_section(Section& parent, std::string_view key) {
  const toml::node* node = find_key(parent, key);
  if (node != nullptr && !node->is_table()) {
    fail_type(parent, key, *node, "a table [" + dotted(parent, key) + "]");
  }
  return {node != nullptr ? node->as_table() : nullptr, parent.file, dotted(parent, key), {}};
}

std::vector<Section> read_sections(Section& parent, std::string_view key) {
  std::vector<Section> sections;
  const toml::node* node = find_key(parent, key);
  if (node == nullptr) return sections;
  const std::string wanted = "tables [[" + dotted(parent, key) + "]]";
  if (!node->is_array()) fail_type(parent, key, *node, wanted);
  for (const toml::node& entry : *node->as_array()) {
    if (!entry.is_table()) fail_type(parent, key, entry, wanted);
    sections.push_back({entry.as_table(), parent.file, dotted(parent, key), {}});
  }
  return sections;
}

std::vector<NamedSection> read_named_sections(Section& parent, std::string_view key) {
  std::vector<NamedSection> sections;
  const Section outer = read_section(parent, key);
  if (outer.table == nullptr) return sections;
  for (const auto& [name, node] : *outer.table) {
    const std::string full_name = dotted(outer, name.str());
    if (!node.is_table()) fail_type(outer, name.str(), node, "a table [" + full_name + "]");
    sections.push_back({std::string(name.str()), {node.as_table(), parent.file, full_name, {}}});
  }
  // toml++ keeps a table sorted by name; the file's order is what a reader expects.
  std::stable_sort(sections.begin(), sections.end(), [](const auto& a, const auto& b) {
    return a.section.table->source().begin.line < b.section.table->source().begin.line;
  });
  return sections;
}

void finish_section(const Section& section) {
  if (section.table == nullptr) return;
  const auto is_known = [&](std::string_view key) {
    return std::find(section.known_keys.begin(), section.known_keys.end(), key) !=
           section.known_keys.end();
  };
  const toml::key* unknown = nullptr;
  for (const auto& [key, node] : *section.table) {
    if (is_known(key.str())) continue;
    if (unknown == nullptr || key.source().begin.line < unknown->source().begin.line) {
      unknown = &key;
    }
  }
  if (unknown != nullptr) {
    fail_at_line(section, unknown->source().begin.line, unknown->str(),
                 "there is no such key; here are " + list_words(section.known_keys) +
                     did_you_mean(unknown->str(), section.known_keys));
  }
}

std::string list_words(std::span<const std::string> words) {
  std::string list;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) list += i + 1 == words.size() ? " and " : ", ";
    list += words[i];
  }
  return list;
}

}  // namespace softfocus

#include "scenes/files/scene_error.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace softfocus {

namespace {

/// How many bytes the UTF-8 letter at the beginning has, and its code; none if it is no UTF-8.
std::pair<std::size_t, char32_t> first_letter(std::string_view text) {
  const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(text[at]); };
  const unsigned first = byte(0);
  if (first < 0x80) return {1, first};
  const std::size_t count = first >> 5 == 0x6    ? 2
                            : first >> 4 == 0xE  ? 3
                            : first >> 3 == 0x1E ? 4
                                                 : 0;
  if (count == 0 || text.size() < count) return {0, 0};
  char32_t code = first & (0x7Fu >> count);
  for (std::size_t i = 1; i < count; ++i) {
    if (byte(i) >> 6 != 2) return {0, 0};
    code = code << 6 | (byte(i) & 0x3Fu);
  }
  constexpr char32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool is_right = code >= kLeast[count] && code <= 0x10FFFF && code >> 11 != 0x1B;
  return is_right ? std::pair{count, code} : std::pair<std::size_t, char32_t>{0, 0};
}

bool is_deceiving(char32_t code) {
  const bool is_control = code < 0x20 || (code >= 0x7F && code < 0xA0);
  const bool is_separator = code == 0x2028 || code == 0x2029;
  const bool is_direction = code == 0x061C || code == 0x200E || code == 0x200F ||
                            (code >= 0x202A && code <= 0x202E) ||
                            (code >= 0x2066 && code <= 0x2069);
  return is_control || is_separator || is_direction;
}

}  // namespace

std::string printable(std::string_view text) {
  std::string shown;
  while (!text.empty()) {
    const auto [count, code] = first_letter(text);
    if (count == 0 || is_deceiving(code)) {
      shown.push_back('?');
    } else {
      shown.append(text.substr(0, count));
    }
    text.remove_prefix(std::max<std::size_t>(count, 1));
  }
  return shown;
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  // Rows of the table of distances between beginnings: of a's first i letters, and of one and two
  // letters fewer.
  std::vector<std::size_t> costs(b.size() + 1), before(b.size() + 1), two_before(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) costs[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    two_before.swap(before);
    before.swap(costs);
    costs[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = before[j - 1] + (a[i - 1] != b[j - 1] ? 1 : 0);
      costs[j] = std::min({replaced, before[j] + 1, costs[j - 1] + 1});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        costs[j] = std::min(costs[j], two_before[j - 2] + 1);
      }
    }
  }
  return costs[b.size()];
}

std::string did_you_mean(std::string_view mistyped, std::span<const std::string> names) {
  // A text of a million letters is no slip of the finger, and its table would take a while.
  constexpr std::size_t kLongestName = 64, kMostEdits = 3, kShortestBeginning = 3;
  const auto ending = [](const std::string& name) { return "; did you mean '" + name + "'?"; };
  if (mistyped.size() > kLongestName) return {};
  const std::size_t letters =
      mistyped.size() - std::min(mistyped.find_first_not_of('-'), mistyped.size());
  std::size_t least = std::min(letters / 3, kMostEdits) + 1;
  const std::string* nearest = nullptr;
  for (const std::string& name : names) {
    const std::size_t distance = edit_distance(mistyped, name);
    if (distance >= least) continue;
    least = distance;
    nearest = &name;
  }
  if (nearest != nullptr) return ending(*nearest);
  for (const std::string& name : names) {
    if (letters >= kShortestBeginning && name.starts_with(mistyped)) return ending(name);
  }
  return {};
}

}  // namespace softfocus

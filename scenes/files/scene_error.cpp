#include "scenes/files/scene_error.h"

#include <algorithm>
#include <vector>

namespace softfocus {

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

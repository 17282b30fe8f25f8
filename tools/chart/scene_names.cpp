#include "tools/chart/scene_names.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>

#include "tools/cli/errors.h"

namespace softfocus {
namespace {

constexpr std::string_view kRandom = "random:", kTo = "..";

/// More scenes than days have minutes are a slip of the finger.
constexpr std::uint64_t kMostSeeds = 1000;

struct SeedRange {
  std::uint64_t first;
  std::uint64_t last;
};

std::optional<std::uint64_t> seed_of(std::string_view text) {
  std::uint64_t seed = 0;
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, seed);
  if (read.ec != std::errc{} || read.ptr != end) return std::nullopt;
  return seed;
}

/// The range of "random:8..11"; nullopt for a name that has no "..".
std::optional<SeedRange> seed_range(std::string_view name) {
  if (!name.starts_with(kRandom)) return std::nullopt;
  const std::string_view seeds = name.substr(kRandom.size());
  const std::size_t to = seeds.find(kTo);
  if (to == seeds.npos) return std::nullopt;
  const auto first = seed_of(seeds.substr(0, to)), last = seed_of(seeds.substr(to + kTo.size()));
  if (!first || !last || *last < *first || *last - *first >= kMostSeeds) {
    throw UsageError("--scenes '" + std::string{name} +
                     "': give a range of at most 1000 seeds, such as random:64..127");
  }
  return SeedRange{*first, *last};
}

void add_once(const std::string& option, const std::string& text, const std::string& name,
              std::vector<std::string>& names) {
  if (std::find(names.begin(), names.end(), name) != names.end()) {
    throw UsageError(option + " '" + text + "': '" + name + "' stands there twice");
  }
  names.push_back(name);
}

}  // namespace

std::vector<std::string> listed_names(const std::string& option, const std::string& text) {
  std::vector<std::string> names;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    const std::string name = text.substr(start, end - start);
    start = end + 1;
    if (name.empty()) {
      throw UsageError(std::string{option}.append(" '").append(text).append(
          "': give names with a comma between two"));
    }
    add_once(option, text, name, names);
  }
  return names;
}

std::vector<std::string> scene_names(const std::string& text) {
  std::vector<std::string> names;
  for (const std::string& name : listed_names("--scenes", text)) {
    const auto range = seed_range(name);
    if (!range) {
      add_once("--scenes", text, name, names);
      continue;
    }
    for (std::uint64_t i = 0; i <= range->last - range->first; ++i) {
      std::string seed{kRandom};
      seed += std::to_string(range->first + i);
      add_once("--scenes", text, seed, names);
    }
  }
  return names;
}

std::string name_for_files(std::string_view scene) {
  std::string name{scene};
  std::replace(name.begin(), name.end(), ':', '-');
  return name;
}

}  // namespace softfocus

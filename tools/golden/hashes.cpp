#include "tools/golden/hashes.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <map>

namespace softfocus {
namespace {

struct TableEntry {
  const char* name;
  std::uint64_t hash;
};

constexpr TableEntry kTable[] = {
#include "tools/golden/table.inc"
};

}  // namespace

std::vector<NamedHash> golden_hashes(ThreadPool& pool) {
  std::vector<NamedHash> hashes = number_hashes();
  const auto append = [&](std::vector<NamedHash> more) {
    hashes.insert(hashes.end(), std::move_iterator(more.begin()), std::move_iterator(more.end()));
  };
  append(sampler_hashes(profiles()));
  append(frame_hashes(load_golden_scenes(pool), profiles(), pool));
  append(more_frame_hashes(pool));
  return hashes;
}

std::vector<NamedHash> expected_hashes() {
  std::vector<NamedHash> hashes;
  for (const TableEntry& entry : kTable) hashes.push_back({entry.name, entry.hash});
  return hashes;
}

std::vector<HashCheck> check_hashes(std::span<const NamedHash> expected,
                                    std::span<const NamedHash> computed) {
  std::map<std::string, std::uint64_t> left;
  for (const NamedHash& entry : expected) left.emplace(entry.name, entry.hash);
  std::vector<HashCheck> checks;
  for (const NamedHash& entry : computed) {
    HashCheck& check = checks.emplace_back(HashCheck{entry.name, std::nullopt, entry.hash});
    if (const auto found = left.find(entry.name); found != left.end()) {
      check.expected = found->second;
      left.erase(found);
    }
  }
  for (const auto& [name, hash] : left) checks.push_back({name, hash, std::nullopt});
  return checks;
}

std::string describe_failures(std::span<const HashCheck> checks) {
  const auto first = std::find_if_not(checks.begin(), checks.end(), passes);
  if (first == checks.end()) return "";
  const auto differing = std::count_if(first, checks.end(), std::not_fn(passes));
  const auto text = [](const std::optional<std::uint64_t>& hash) {
    return hash ? hash_text(*hash) : std::string{"nothing"};
  };
  return std::to_string(differing) + " of " + std::to_string(checks.size()) +
         " hashes differ; the first is '" + first->name + "': expected " + text(first->expected) +
         ", computed " + text(first->computed);
}

}  // namespace softfocus

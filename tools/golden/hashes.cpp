#include "tools/golden/hashes.h"

#include <algorithm>
#include <cassert>
#include <functional>
#include <iterator>
#include <map>

#include "scenes/load/load_scene.h"

namespace softfocus {
namespace {

struct TableEntry {
  const char* name;
  std::uint64_t hash;
};

constexpr TableEntry kTable[] = {
#include "tools/golden/table.inc"
};

bool is_in(GoldenSet set, std::string_view name) {
  if (set == GoldenSet::all) return true;
  const FrameSize& left_out = golden_sizes().front();
  if (name.ends_with(' ' + std::to_string(left_out.width) + 'x' +
                     std::to_string(left_out.height))) {
    return false;
  }
  const auto is_of = [&](std::string_view scene) {
    return name.starts_with(scene) && name.substr(scene.size()).starts_with(' ');
  };
  const auto others = golden_scenes().subspan(1);
  return std::none_of(others.begin(), others.end(), is_of) || name.find(" ieee ") != name.npos;
}

}  // namespace

std::vector<NamedHash> golden_hashes(ThreadPool& pool, GoldenSet set) {
  std::vector<NamedHash> hashes = number_hashes();
  const auto append = [&](std::vector<NamedHash> more) {
    hashes.insert(hashes.end(), std::move_iterator(more.begin()), std::move_iterator(more.end()));
  };
  append(sampler_hashes(profiles()));
  const std::vector<GoldenScene> loaded = load_golden_scenes(pool);
  const std::span<const GoldenScene> scenes{loaded};
  const std::size_t on_all = set == GoldenSet::quick ? 1 : scenes.size();
  append(frame_hashes(scenes.first(on_all), golden_sizes(set), profiles(), pool));
  append(frame_hashes(scenes.subspan(on_all), golden_sizes(set), profiles().first(1), pool));
  append(more_frame_hashes(more_golden_scenes(), pool));
  return hashes;
}

std::size_t golden_part_count() {
  const std::size_t frames = golden_scenes().size() * golden_sizes().size() * profiles().size();
  return 1 + profiles().size() + frames + more_golden_scenes().size();
}

std::vector<NamedHash> golden_part(std::size_t part, ThreadPool& pool) {
  assert(part < golden_part_count());
  if (part == 0) return number_hashes();
  part -= 1;
  if (part < profiles().size()) return sampler_hashes(profiles().subspan(part, 1));
  part -= profiles().size();
  const std::size_t of_scene = golden_sizes().size() * profiles().size();
  if (part < golden_scenes().size() * of_scene) {
    const std::string_view name = golden_scenes()[part / of_scene];
    const GoldenScene scene{std::string{name}, load_scene(name, scene_search_path({}))};
    const std::size_t place = part % of_scene;
    return frame_hashes(scene, golden_sizes()[place / profiles().size()],
                        profiles()[place % profiles().size()], pool);
  }
  part -= golden_scenes().size() * of_scene;
  return more_frame_hashes(more_golden_scenes().subspan(part, 1), pool);
}

std::vector<NamedHash> expected_hashes(GoldenSet set) {
  std::vector<NamedHash> hashes;
  for (const TableEntry& entry : kTable) {
    if (is_in(set, entry.name)) hashes.push_back({entry.name, entry.hash});
  }
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

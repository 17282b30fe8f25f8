#include "tools/golden/hashes.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <memory>

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

// Shapes without a texture; textures, and what moves; what is seen through.
constexpr std::array<std::string_view, 3> kFewScenes{"figures", "cube-room", "glass"};

bool is_few(std::string_view scene) {
  return std::find(kFewScenes.begin(), kFewScenes.end(), scene) != kFewScenes.end();
}

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
  const bool is_ieee = name.find(" ieee") != name.npos;
  if (set == GoldenSet::few) {
    return is_of("number") ||
           (is_ieee && (is_of("mipmaps") || is_of("sampler") ||
                        std::any_of(kFewScenes.begin(), kFewScenes.end(), is_of)));
  }
  const auto others = golden_scenes().subspan(1);
  return std::none_of(others.begin(), others.end(), is_of) || is_ieee;
}

std::span<const NamedProfile> golden_profiles(GoldenSet set, bool is_first) {
  return set == GoldenSet::all || (set == GoldenSet::quick && is_first) ? profiles()
                                                                        : profiles().first(1);
}

std::vector<std::string_view> more_scenes_of(GoldenSet set) {
  std::vector<std::string_view> scenes;
  for (const std::string_view scene : more_golden_scenes()) {
    if (set != GoldenSet::few || is_few(scene)) scenes.push_back(scene);
  }
  return scenes;
}

// All but more_frame_hashes().
std::vector<GoldenPart> first_parts(GoldenSet set) {
  std::vector<GoldenPart> parts{[](ThreadPool&) { return number_hashes(); }};
  for (const NamedProfile& profile : golden_profiles(set, true)) {
    parts.emplace_back([&profile](ThreadPool&) { return sampler_hashes({&profile, 1}); });
  }
  for (const std::string_view name : golden_scenes()) {
    if (set == GoldenSet::few && !is_few(name)) continue;
    // Making a scene's textures takes longer than drawing it small.
    const auto loaded = std::make_shared<GoldenScene>();
    for (const FrameSize& size : golden_sizes(set)) {
      for (const NamedProfile& profile : golden_profiles(set, name == golden_scenes().front())) {
        parts.emplace_back([name, loaded, &size, &profile](ThreadPool& pool) {
          if (loaded->name.empty()) {
            *loaded = {std::string{name}, load_scene(name, scene_search_path({}))};
          }
          return frame_hashes(*loaded, size, profile, pool);
        });
      }
    }
  }
  return parts;
}

}  // namespace

std::vector<NamedHash> golden_hashes(ThreadPool& pool, GoldenSet set) {
  std::vector<NamedHash> hashes;
  const auto append = [&](std::vector<NamedHash> more) {
    hashes.insert(hashes.end(), std::move_iterator(more.begin()), std::move_iterator(more.end()));
  };
  for (const GoldenPart& part : first_parts(set)) append(part(pool));
  append(more_frame_hashes(more_scenes_of(set), pool));
  return hashes;
}

std::vector<GoldenPart> golden_parts(GoldenSet set) {
  std::vector<GoldenPart> parts = first_parts(set);
  for (const std::string_view scene : more_scenes_of(set)) {
    parts.emplace_back([scene](ThreadPool& pool) { return more_frame_hashes({&scene, 1}, pool); });
  }
  return parts;
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

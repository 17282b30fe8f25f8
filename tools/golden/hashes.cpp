#include "tools/golden/hashes.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <iterator>
#include <memory>
#include <sstream>

#include "scenes/load/load_scene.h"

namespace softfocus {
namespace {

struct TableEntry {
  const char* name;
  std::uint64_t hash;
  const char* ends;
};

constexpr TableEntry kTable[] = {
#include "tools/golden/table.inc"
};

std::uint16_t end_of(std::uint64_t hash) { return static_cast<std::uint16_t>(hash); }

// Shapes without a texture; textures, and what moves; what is seen through.
constexpr std::array<std::string_view, 3> kFewScenes{"figures", "cube-room", "glass"};

bool is_few(std::string_view scene) {
  return std::find(kFewScenes.begin(), kFewScenes.end(), scene) != kFewScenes.end();
}

bool is_in(GoldenSet set, std::string_view group) {
  if (set == GoldenSet::all) return true;
  const FrameSize& left_out = golden_sizes().front();
  const std::string size = std::to_string(left_out.width) + 'x' + std::to_string(left_out.height);
  if (group.ends_with(size)) return false;
  const auto has_group = [&](std::string_view branch) { return is_below(branch, group); };
  const bool is_ieee = group.find(" ieee") != group.npos;
  if (set == GoldenSet::few) {
    return group == "number" ||
           (is_ieee && (has_group("samplers") ||
                        std::any_of(kFewScenes.begin(), kFewScenes.end(), has_group)));
  }
  const auto others = golden_scenes().subspan(1);
  return std::none_of(others.begin(), others.end(), has_group) || is_ieee;
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

std::string branch_of(std::string_view place, std::string_view profile) {
  return std::string{place}.append(" ").append(profile);
}

// All but more_frame_hashes().
std::vector<GoldenPart> first_parts(GoldenSet set) {
  std::vector<GoldenPart> parts{{"number", [](ThreadPool&) { return number_hashes(); }}};
  for (const NamedProfile& profile : golden_profiles(set, true)) {
    parts.push_back({branch_of("samplers", profile.name), [&profile](ThreadPool&) {
                       return sampler_hashes({&profile, 1});
                     }});
  }
  for (const std::string_view name : golden_scenes()) {
    if (set == GoldenSet::few && !is_few(name)) continue;
    // Making a scene's textures takes longer than drawing it small.
    const auto loaded = std::make_shared<GoldenScene>();
    for (const FrameSize& size : golden_sizes(set)) {
      for (const NamedProfile& profile : golden_profiles(set, name == golden_scenes().front())) {
        parts.push_back(
            {branch_of(name, profile.name), [name, loaded, &size, &profile](ThreadPool& pool) {
               if (loaded->name.empty()) {
                 *loaded = {std::string{name}, load_scene(name, scene_search_path({}), &pool)};
               }
               return frame_hashes(*loaded, size, profile, pool);
             }});
      }
    }
  }
  return parts;
}

void append(std::vector<NamedHash>& hashes, std::vector<NamedHash> more) {
  hashes.insert(hashes.end(), std::move_iterator(more.begin()), std::move_iterator(more.end()));
}

/// Checks of a group that is in the table and whose hash is not the table's.
std::vector<HashCheck> check_members(const HashGroup& expected,
                                     std::span<const NamedHash> members) {
  std::vector<HashCheck> checks;
  checks.reserve(members.size());
  std::vector<std::uint16_t> left = expected.ends;
  const bool is_whole = left.size() == members.size();
  for (std::size_t i = 0; i < members.size(); ++i) {
    HashCheck& check = checks.emplace_back(HashCheck{members[i].name, {}, members[i].hash});
    if (is_whole) {
      check.expected = expected.ends[i];
      check.passes = check.expected == end_of(members[i].hash);
    } else if (const auto found = std::find(left.begin(), left.end(), end_of(members[i].hash));
               found != left.end()) {
      check.expected = *found;
      check.passes = true;
      left.erase(found);
    }
  }
  if (!is_whole) {
    for (const std::uint16_t end : left) checks.push_back({expected.name, end});
  }
  const auto passes = [](const HashCheck& check) { return check.passes; };
  if (std::all_of(checks.begin(), checks.end(), passes)) {
    for (HashCheck& check : checks) check.passes = false;
  }
  return checks;
}

}  // namespace

std::string group_of(std::string_view member) {
  const std::string_view kind = member.substr(0, member.find(' '));
  if (kind == "number") return std::string{kind};
  const std::size_t size = member.rfind(' ');
  if (kind == "mipmaps" || kind == "sampler") {
    return "samplers" + std::string{member.substr(size)};
  }
  return std::string{kind} + std::string{member.substr(member.rfind(' ', size - 1))};
}

bool is_below(std::string_view branch, std::string_view group) {
  if (branch.empty()) return true;
  return group.starts_with(branch) &&
         (group.size() == branch.size() || group[branch.size()] == ' ');
}

std::vector<HashGroup> groups_of(std::span<const NamedHash> hashes) {
  std::vector<HashGroup> groups;
  for (const auto& [name, hash] : hashes) {
    const std::string group = group_of(name);
    auto found = std::find_if(groups.begin(), groups.end(),
                              [&](const HashGroup& one) { return one.name == group; });
    if (found == groups.end()) found = groups.insert(found, {group, Hash{}.value});
    Hash sum{found->hash};
    for (const char letter : name) add_to_hash(sum, static_cast<std::uint8_t>(letter));
    add_to_hash(sum, hash);
    found->hash = sum.value;
    found->ends.push_back(end_of(hash));
  }
  return groups;
}

std::size_t member_count(std::span<const HashGroup> groups) {
  std::size_t count = 0;
  for (const HashGroup& group : groups) count += group.ends.size();
  return count;
}

std::vector<NamedHash> golden_hashes(ThreadPool& pool, GoldenSet set, std::string_view branch) {
  const auto is_wanted = [&](const std::string& part) {
    return is_below(branch, part) || is_below(part, branch);
  };
  std::vector<NamedHash> hashes;
  for (const GoldenPart& part : first_parts(set)) {
    if (is_wanted(part.branch)) append(hashes, part.hashes(pool));
  }
  std::vector<std::string_view> more = more_scenes_of(set);
  std::erase_if(more, [&](std::string_view scene) { return !is_wanted(branch_of(scene, "ieee")); });
  append(hashes, more_frame_hashes(more, pool));
  std::erase_if(hashes,
                [&](const NamedHash& one) { return !is_below(branch, group_of(one.name)); });
  return hashes;
}

std::vector<GoldenPart> golden_parts(GoldenSet set) {
  std::vector<GoldenPart> parts = first_parts(set);
  for (const std::string_view scene : more_scenes_of(set)) {
    parts.push_back({branch_of(scene, "ieee"), [scene](ThreadPool& pool) {
                       return more_frame_hashes({&scene, 1}, pool);
                     }});
  }
  return parts;
}

std::vector<HashGroup> expected_groups(GoldenSet set, std::string_view branch) {
  std::vector<HashGroup> groups;
  for (const auto& [name, hash, ends] : kTable) {
    if (!is_in(set, name) || !is_below(branch, name)) continue;
    HashGroup& group = groups.emplace_back(HashGroup{name, hash});
    std::istringstream words{ends};
    words >> std::hex;
    for (std::uint16_t end = 0; words >> end;) group.ends.push_back(end);
  }
  return groups;
}

std::vector<HashCheck> check_hashes(std::span<const HashGroup> expected,
                                    std::span<const NamedHash> computed) {
  std::vector<HashGroup> left(expected.begin(), expected.end());
  std::vector<HashCheck> checks;
  checks.reserve(computed.size());
  for (const HashGroup& group : groups_of(computed)) {
    std::vector<NamedHash> members;
    for (const NamedHash& one : computed) {
      if (group_of(one.name) == group.name) members.push_back(one);
    }
    const auto wanted = std::find_if(left.begin(), left.end(),
                                     [&](const HashGroup& one) { return one.name == group.name; });
    if (wanted == left.end()) {
      for (const auto& [name, hash] : members) checks.push_back({name, {}, hash});
    } else if (wanted->hash == group.hash) {
      for (const auto& [name, hash] : members) checks.push_back({name, end_of(hash), hash, true});
    } else {
      const std::vector<HashCheck> found = check_members(*wanted, members);
      checks.insert(checks.end(), found.begin(), found.end());
    }
    if (wanted != left.end()) left.erase(wanted);
  }
  for (const HashGroup& group : left) {
    for (const std::uint16_t end : group.ends) checks.push_back({group.name, end});
  }
  return checks;
}

std::string end_text(std::uint16_t end) { return hash_text(end).substr(14); }

std::string describe_failures(std::span<const HashCheck> checks) {
  const auto fails = [](const HashCheck& check) { return !check.passes; };
  const auto first = std::find_if(checks.begin(), checks.end(), fails);
  if (first == checks.end()) return "";
  std::string text = std::to_string(std::count_if(first, checks.end(), fails)) + " of " +
                     std::to_string(checks.size()) + " hashes differ; the first is '" +
                     first->name + "': ";
  if (first->expected && first->computed && *first->expected == end_of(*first->computed)) {
    return text + "no end differs from the table's, but the hash of its group does";
  }
  text += "expected ";
  text += first->expected ? "one that ends in " + end_text(*first->expected) : "nothing";
  text += ", computed ";
  text += first->computed ? hash_text(*first->computed) : "nothing";
  return text;
}

}  // namespace softfocus

#pragma once
// Fingerprints of what must have the same bits everywhere: frames, samplers, numbers.
// `softfocus selftest` and the tests hold them against one table, golden/table.inc: a hash for
// each group.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "raster/numbers/profile.h"
#include "raster/threads/parallel.h"
#include "scenes/scene.h"
#include "tools/files/hash_text.h"

namespace softfocus {

/// What was computed, in words, and the FNV-1a hash of its bits.
struct NamedHash {
  std::string name;
  std::uint64_t hash = 0;
};

struct GoldenScene {
  std::string name;
  Scene scene;
};

/// The thesis's three scenes, as load_scene() takes them, and loaded. Throws SceneError.
std::span<const std::string_view> golden_scenes();
std::vector<GoldenScene> load_golden_scenes(ThreadPool& pool);

/// Golden hashes are the leaves of a tree: a scene, or samplers or numbers; a group below it, which
/// has one profile and one size; the group's members.
struct HashGroup {
  std::string name;        ///< "SCENE PROFILE WIDTHxHEIGHT", "samplers PROFILE" or "number"
  std::uint64_t hash = 0;  ///< of its members' names and hashes, in their order
  std::vector<std::uint16_t>
      ends{};  ///< last 16 bits of each member's hash: they tell members apart
};

/// The group of a member, by the member's name.
std::string group_of(std::string_view member);

/// Whether a group is `branch` or below it: "figures" has "figures ieee 97x61", "" has all.
bool is_below(std::string_view branch, std::string_view group);

/// The groups of some hashes, in the order of their first members.
std::vector<HashGroup> groups_of(std::span<const NamedHash> hashes);

/// How many members groups have together.
std::size_t member_count(std::span<const HashGroup> groups);

/// Which of the golden hashes. `quick` lacks the frames of the larger size, and has profiles other
/// than ieee on the first scene alone: every operation is left. Of these `few` has what byte order
/// and words can change: under ieee, and three scenes.
enum class GoldenSet { all, quick, few };

struct FrameSize {
  int width, height;
};
/// A size of whole tiles, and a smaller one with parts of tiles.
std::span<const FrameSize> golden_sizes(GoldenSet set = GoldenSet::all);

/// "SCENE METHOD PROFILE WIDTHxHEIGHT": every method and, at the smaller size, every effect.
std::vector<NamedHash> frame_hashes(const GoldenScene& scene, const FrameSize& size,
                                    const NamedProfile& profile, ThreadPool& pool);

/// "SCENE relief-WHAT ieee WIDTHxHEIGHT": textures of both depths, every resampling with both kinds
/// of numbers, and the last of them mapped.
std::vector<NamedHash> relief_hashes(const GoldenScene& scene, ThreadPool& pool);

/// Other scenes that come along and some random ones, as load_scene() takes them.
std::span<const std::string_view> more_golden_scenes();

/// Names as in frame_hashes(), for scenes such as these: few methods, one profile, one size.
std::vector<NamedHash> more_frame_hashes(std::span<const std::string_view> scenes,
                                         ThreadPool& pool);

/// "sampler FILTER FORMAT PROFILE": random textures, every wrap, coordinates and levels
/// inside and far outside; "mipmaps FORMAT PROFILE": their levels.
std::vector<NamedHash> sampler_hashes(std::span<const NamedProfile> profiles);

/// "number ...": half, 8 bits, fixed point, fused multiply-add, exact_math.
std::vector<NamedHash> number_hashes();

/// All of the above, under every profile, whose groups are below `branch`.
std::vector<NamedHash> golden_hashes(ThreadPool& pool, GoldenSet set = GoldenSet::all,
                                     std::string_view branch = {});

/// The same in parts, in the order of golden_hashes(), for callers that want to stop in between. A
/// part takes a second at most and has whole groups. Parts of a scene share it once it is loaded.
struct GoldenPart {
  std::string branch;  ///< "SCENE PROFILE", "samplers PROFILE" or "number"
  std::function<std::vector<NamedHash>(ThreadPool&)> hashes;
};
std::vector<GoldenPart> golden_parts(GoldenSet set = GoldenSet::all);

/// The table: the groups that golden_hashes() must give.
std::vector<HashGroup> expected_groups(GoldenSet set = GoldenSet::all,
                                       std::string_view branch = {});

/// One golden hash and what became of it.
struct HashCheck {
  std::string name;                         ///< its group's if nothing was computed
  std::optional<std::uint16_t> expected{};  ///< how the hash ends; none: the table lacks it
  std::optional<std::uint64_t> computed{};
  bool passes = false;
};

/// What was computed against the table, in the computed order; of the table what was not computed
/// comes last. A group whose hash is the table's passes as a whole. Of another group those members
/// fail whose ends differ from the table's, or all if no end differs.
std::vector<HashCheck> check_hashes(std::span<const HashGroup> expected,
                                    std::span<const NamedHash> computed);

/// "345a": how a hash ends, as the table has it.
std::string end_text(std::uint16_t end);

/// What does not pass, in words that name the first; empty where all do.
std::string describe_failures(std::span<const HashCheck> checks);

}  // namespace softfocus

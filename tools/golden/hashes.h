#pragma once
// Fingerprints of what must have the same bits everywhere: frames, samplers, numbers.
// `softfocus selftest` and the tests hold them against one table, golden/table.inc.

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

/// All of the above under every profile.
std::vector<NamedHash> golden_hashes(ThreadPool& pool, GoldenSet set = GoldenSet::all);

/// The same in parts, in the order of golden_hashes(), for callers that want to stop in between. A
/// part takes a second at most. Parts of a scene share it once it is loaded.
using GoldenPart = std::function<std::vector<NamedHash>(ThreadPool&)>;
std::vector<GoldenPart> golden_parts(GoldenSet set = GoldenSet::all);

/// The table: what golden_hashes() must give.
std::vector<NamedHash> expected_hashes(GoldenSet set = GoldenSet::all);

/// One entry of the table and what became of it.
struct HashCheck {
  std::string name;
  std::optional<std::uint64_t> expected;  ///< none: the table lacks it
  std::optional<std::uint64_t> computed;  ///< none: nothing of that name was computed
};

inline bool passes(const HashCheck& check) { return check.expected == check.computed; }

/// What was computed against what was expected, in the computed order; what is left of
/// the expected comes last.
std::vector<HashCheck> check_hashes(std::span<const NamedHash> expected,
                                    std::span<const NamedHash> computed);

/// What does not pass, in words that name the first; empty where all do.
std::string describe_failures(std::span<const HashCheck> checks);

}  // namespace softfocus

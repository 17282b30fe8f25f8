#pragma once
// Fingerprints of what must have the same bits everywhere: frames, samplers, numbers.
// `softfocus selftest` and the tests hold them against one table, golden/table.inc.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
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

/// The thesis's three scenes. Throws SceneError.
std::vector<GoldenScene> load_golden_scenes(ThreadPool& pool);

/// "SCENE METHOD PROFILE WIDTHxHEIGHT": every method, at a small size and an odd one.
std::vector<NamedHash> frame_hashes(std::span<const GoldenScene> scenes,
                                    std::span<const NamedProfile> profiles, ThreadPool& pool);

/// The same names, for the other scenes that come along and some random ones: few methods, one
/// profile, one size.
std::vector<NamedHash> more_frame_hashes(ThreadPool& pool);

/// "sampler FILTER FORMAT PROFILE": random textures, every wrap, coordinates and levels
/// inside and far outside; "mipmaps FORMAT PROFILE": their levels.
std::vector<NamedHash> sampler_hashes(std::span<const NamedProfile> profiles);

/// "number ...": half, 8 bits, fixed point, fused multiply-add, exact_math.
std::vector<NamedHash> number_hashes();

/// All of the above under every profile.
std::vector<NamedHash> golden_hashes(ThreadPool& pool);

/// The table: what golden_hashes() must give.
std::vector<NamedHash> expected_hashes();

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

#pragma once
// The steps of a view's rays, as a search for what they see needs them.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "scenes/filtered_views/lens_cells.h"
#include "scenes/filtered_views/view_spread.h"
#include "scenes/filtered_views/view_tiles.h"

namespace softfocus {

/// A tile's planes, with what rays reach around it, have so many rows, so many numbers apart.
inline constexpr int kSpreadRows = kSpreadTile + 2 * kMostSpreadStep;
inline constexpr int kSpreadStride = kSpreadRows + 16;

/// Levels, counted from 0, as bits.
struct LevelSet {
  static constexpr int kWords = (kSpreadLevels + 63) / 64;
  std::uint64_t bits[kWords] = {};
  bool operator==(const LevelSet&) const = default;
};

/// Levels from the nearest.
struct LevelList {
  std::array<std::int32_t, kSpreadLevels> number;
  int count = 0;
};
LevelList list_of(const LevelSet& levels);

struct SpreadSteps {
  int rays = 1;
  std::vector<PixelStep> steps;          ///< ray_steps()
  std::vector<std::int32_t> offsets;     ///< the same between pixels of a tile's planes
  std::vector<std::int16_t> same_until;  ///< the last of the levels from each on with its offset
  std::vector<std::int16_t> reach_px;    ///< of each level, over all rays
  /// Of 0, 8, 16, ... pixels: the levels whose steps are longer.
  std::vector<LevelSet> reaching;
};
inline constexpr int kReachStepPx = 8;
/// `in_pixel` is where the view looks from in its pixels (LensCells).
SpreadSteps spread_steps(const ViewSpread& spread, std::span<const glm::dvec2> points,
                         glm::dvec2 in_pixel = glm::dvec2{0.0});

/// Levels that a ray sees at one place.
struct LevelRun {
  std::int32_t offset;
  std::int32_t first;
  std::uint32_t span;  ///< last - first
};

/// What each ray of a view looks for, from the nearest.
struct RayRuns {
  std::array<LevelRun, std::size_t{kMostCellPoints} * kSpreadLevels> runs;  ///< ray by ray
  std::array<std::int32_t, kMostCellPoints + 1> begin;
  /// Whether a ray has one run, which it finds wherever it looks.
  std::array<bool, kMostCellPoints> certain;
  bool all_certain;
};

/// The runs of the levels `sought`. `only_sought`: there are no others where the rays look.
void find_runs(const SpreadSteps& steps, const LevelList& sought, bool only_sought, RayRuns& found);

}  // namespace softfocus

#pragma once
// view_spread.h a tile after the other, in lanes: the oracle's bits.

#include <cstdint>
#include <vector>

#include "raster/images/image.h"
#include "raster/lanes/isa.h"
#include "raster/pipeline/state.h"
#include "scenes/filtered_views/view_spread.h"
#include "scenes/filtered_views/view_tiles.h"

namespace softfocus {

/// Levels, counted from 0, as bits.
struct LevelSet {
  static constexpr int kWords = (kSpreadLevels + 63) / 64;
  std::uint64_t bits[kWords] = {};
};

/// The steps of a view's rays as a tile needs them.
struct SpreadSteps {
  int rays = 1;
  std::vector<PixelStep> steps;        ///< ray_steps()
  std::vector<std::int32_t> offsets;   ///< the same between pixels of a tile's planes
  std::vector<std::int16_t> reach_px;  ///< of each level, over all rays
  /// Of 0, 8, 16, ... pixels: the levels whose steps are longer.
  std::vector<LevelSet> reaching;
};
SpreadSteps spread_steps(const ViewSpread& spread, std::span<const glm::dvec2> points,
                         glm::dvec2 in_pixel = glm::dvec2{0.0});

/// Rows of a tile's planes, with what rays reach around it, are so many numbers apart.
inline constexpr int kSpreadRows = kSpreadTile + 2 * kMostSpreadStep;
inline constexpr int kSpreadStride = kSpreadRows + 16;

/// Memory of a task.
struct SpreadMemory {
  /// Red, green, blue and the level of a tile's pixels and of those around it.
  RowMemory<float> colours;
  RowMemory<std::int32_t> levels;
  /// The sums of a tile's views: planes of kSpreadTile rows of kSpreadTile.
  RowMemory<float> sums;
};
SpreadMemory make_spread_memory();

/// Adds the mean of the rays of a view with levels in one tile to the sums, in binary32, or begins
/// them.
void spread_tile(const ViewTiles& view, const SpreadSteps& steps, int tile, bool begin,
                 SpreadMemory& memory, Isa isa);

}  // namespace softfocus

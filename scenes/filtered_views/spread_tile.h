#pragma once
// view_spread.h a tile after the other, in lanes: the oracle's bits.

#include <cstdint>
#include <memory>

#include "raster/images/image.h"
#include "raster/lanes/isa.h"
#include "scenes/filtered_views/spread_steps.h"
#include "scenes/filtered_views/view_tiles.h"

namespace softfocus {

/// Memory of a task.
struct SpreadMemory {
  /// Red, green, blue and the level of a tile's pixels and of those around it.
  RowMemory<float> colours;
  RowMemory<std::int32_t> levels;
  /// The sums of a tile's views: planes of kSpreadTile rows of kSpreadTile.
  RowMemory<float> sums;
  std::unique_ptr<RayRuns> runs;  ///< of a cell
};
SpreadMemory make_spread_memory();

/// Adds the mean of the rays of a view with levels in one tile to the sums, in binary32, or begins
/// them.
void spread_tile(const ViewTiles& view, const SpreadSteps& steps, int tile, bool begin,
                 SpreadMemory& memory, Isa isa);

}  // namespace softfocus

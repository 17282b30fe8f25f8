#pragma once
// The levels in the cells of a tile and around it: what a cell's rays have to look for.

#include <cstdint>

#include "raster/lanes/isa.h"
#include "scenes/filtered_views/spread_steps.h"

namespace softfocus {

/// Pixels of a cell.
inline constexpr int kCellWidth = 16, kCellHeight = 8;
/// Cells of a tile's planes.
inline constexpr int kCellsAcross = kSpreadRows / kCellWidth;
inline constexpr int kCellsDown = kSpreadRows / kCellHeight;

struct CellLevels {
  LevelSet of[kCellsDown][kCellsAcross];
};

/// Finds the levels of a tile's plane that lie within `reach` pixels of its width x height pixels.
void find_levels(const std::int32_t* levels, int width, int height, int reach, Isa isa,
                 CellLevels& cells);

struct NearLevels {
  LevelSet reaching;  ///< that may come to a cell
  LevelSet all;       ///< that its rays may look at
  bool operator==(const NearLevels&) const = default;
};

/// For a cell of the plane whose rays are at most `reach` pixels long.
NearLevels levels_near(const CellLevels& cells, const SpreadSteps& steps, int cell_x, int cell_y,
                       int reach);

}  // namespace softfocus

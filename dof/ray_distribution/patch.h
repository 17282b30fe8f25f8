#pragma once
// A patch: some cells of one plane of the ray distribution buffer after the other, small enough
// for a cache, and the sums over the planes.
//
// Tiles of a sheet land in it. Where all that lands in a block of 16x16 cells moves alike and
// fills it, nothing hides anything: the block's cells are the moved pixels. Such planes are
// noted and added up together; the others go through cells with radii.

#include <array>
#include <cstdint>
#include <vector>

#include "dof/ray_distribution/landings.h"
#include "dof/ray_distribution/patch_cells.h"
#include "dof/ray_distribution/sheet.h"

namespace softfocus {

/// Rows of a tile that do not move alike, as bits, and from where to where the pixels of each
/// move, in cells.
struct UnevenRows {
  std::uint32_t rows;
  std::int32_t x0[kReachTile], x1[kReachTile], y0[kReachTile], y1[kReachTile];
};

struct Patch {
  int x = 0, y = 0;  ///< its first cell in the picture
  Candidates visible, hidden;
  std::vector<Landing> landings;
  std::vector<UnevenRows> uneven;  ///< of each landing
  std::vector<float> cells, sums;
  /// Of each block: the planes that filled it. They count as one for all its cells.
  std::array<int, kBlocks> filled;
  /// Of each block: where the moved pixels begin that are still to be added, in floats from the
  /// first of their sheet.
  std::array<std::vector<std::ptrdiff_t>, kBlocks> moved;
};

/// Begins a patch: its sums are 0. The blocks that any pixel which moves can reach; in the
/// others every cell's mean is its own pixel.
Blocks begin_patch(const Sheet& visible, const Sheet& hidden, int x, int y, Patch& patch);

/// Adds the plane of a point of the lens to the sums of some blocks.
void add_plane(const Sheet& visible, const Sheet& hidden, LensPoint lens, Blocks blocks,
               Patch& patch, Isa isa);

/// Adds what add_plane() noted.
void finish_patch(const Sheet& visible, Patch& patch, Isa isa);

}  // namespace softfocus

#pragma once
// Where the tiles of a sheet land in a patch of 128x32 cells, and in which of its blocks.

#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "dof/ray_distribution/ray_distribution.h"
#include "dof/ray_distribution/sheet.h"

namespace softfocus {

inline constexpr int kPatchColumns = 128, kPatchRows = 32;
inline constexpr int kBlock = kReachTile;
inline constexpr int kBlocksAcross = kPatchColumns / kBlock;
inline constexpr int kBlocks = kBlocksAcross * (kPatchRows / kBlock);

/// Blocks are bits of a mask, row by row.
using Blocks = std::uint64_t;
inline constexpr Blocks kAllBlocks = ~Blocks{0} >> (64 - kBlocks);

/// How far a pixel moves: to the nearest cell, ties to even.
inline int whole_cells(float move) { return static_cast<int>(std::nearbyint(move)); }

template <class Visit>
void for_each_block(Blocks blocks, const Visit& visit) {
  for (; blocks != 0; blocks &= blocks - 1) visit(std::countr_zero(blocks));
}

/// Tiles that may land in a patch, row by row of tiles. Arrays end at a whole vector of the
/// widest unit.
struct Candidates {
  std::vector<float> least, most;   ///< radii
  std::vector<std::int32_t> x, y;   ///< their first pixels, counted from the patch's
  std::vector<std::int32_t> tiles;  ///< their numbers in the sheet
};

/// Where a candidate's first pixel lands: from x0, y0 to x1, y1, the same if all pixels move alike.
struct Landing {
  std::int32_t candidate;
  std::int32_t x0, x1, y0, y1;
  std::int32_t first_row, end_row;  ///< the rows of the patch that are to be drawn

  bool even() const { return x0 == x1 && y0 == y1; }
};

/// The blocks that it shares a cell with.
Blocks blocks_of(const Landing& landing);

/// Finds the tiles whose pixels can reach the patch at x, y. The blocks that pixels can reach which
/// move.
Blocks find_candidates(const Sheet& sheet, int x, int y, Candidates& candidates);

/// Finds where candidates land that move by a point of the lens. How many there are; `landings`
/// has room for all candidates.
int find_landings(const Candidates& candidates, LensPoint lens, Isa isa,
                  std::vector<Landing>& landings);

}  // namespace softfocus

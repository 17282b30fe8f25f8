#pragma once
// Pixels on their way into the buffer, in tiles of 16x16, with the picture's border repeated
// around them: things go on past it.
//
// A point (u, v) of the lens moves a pixel of radius r by round(r u), round(r v). Both are
// monotone in r, so the least and the largest radius of some pixels bound their moves. A range
// also takes in the radii of neighbours of the same surface: where its two ends move alike, all
// its pixels do, and no pixel takes a second cell.

#include <cstdint>
#include <vector>

#include "dof/picture_planes.h"
#include "dof/ray_distribution/behind.h"

namespace softfocus {

struct Sheet {
  Planes pixels;   ///< red, green, blue, radius; kNothingBehind where there is no pixel
  int before = 0;  ///< how far the border is repeated; tile 0 begins that far before the picture
  int tiles_across = 0, tiles_down = 0;
  int reach = 0;  ///< how far a pixel can move at most
  // Ranges without a pixel have a least radius above the largest.
  std::vector<float> row_least, row_most;  ///< of kReachTile rows of each tile
  std::vector<float> least, most;          ///< of tiles
  std::vector<char> whole;                 ///< of tiles: whether every place has a pixel

  /// Row `y`, column 0 of the tiles. Vectors of the widest unit on both sides and a row above
  /// and below may be read.
  const float* row(int plane, int y) const { return plane_row(pixels, plane, y + 1) + kMostLanes; }
};

/// `planes` are red, green, blue and radius. `before` is a multiple of kReachTile.
Sheet make_sheet(const Planes& planes, int before, ThreadPool& pool);

}  // namespace softfocus

#pragma once
// Tiles of 16x16 pixels, to know which discs can matter where.

#include <algorithm>
#include <vector>

#include "raster/threads/parallel.h"

namespace softfocus {

inline constexpr int kReachTile = 16;

/// A flag for each tile, row by row.
struct TileMask {
  int width = 0, height = 0;  ///< in tiles
  std::vector<char> set;
};

inline bool is_set(const TileMask& mask, int x, int y) {
  return mask.set[static_cast<std::size_t>(y / kReachTile * mask.width + x / kReachTile)] != 0;
}

/// For each tile how many pixels its largest disc reaches, -1 without a disc.
struct TileReach {
  int width = 0, height = 0;  ///< in tiles
  std::vector<int> reach_px;
};

TileMask full_mask(int width_px, int height_px);
TileMask both(const TileMask& a, const TileMask& b);

/// The tiles that discs can touch.
TileMask touched(const TileReach& reach);

/// The tiles whose discs can touch a tile of the mask.
TileMask touching(const TileReach& reach, const TileMask& mask);

/// `reach_at(x, y)` is how many pixels the disc of a pixel reaches, -1 without a disc.
template <class ReachAt>
TileReach tile_reach(int width_px, int height_px, ThreadPool& pool, const ReachAt& reach_at) {
  const TileMask size = full_mask(width_px, height_px);
  TileReach reach{size.width, size.height, std::vector<int>(size.set.size(), -1)};
  pool.for_each(reach.height, [&](int tile_y) {
    int* row = &reach.reach_px[static_cast<std::size_t>(tile_y * reach.width)];
    for (int y = tile_y * kReachTile; y < std::min((tile_y + 1) * kReachTile, height_px); ++y) {
      for (int x = 0; x < width_px; ++x) {
        row[x / kReachTile] = std::max(row[x / kReachTile], reach_at(x, y));
      }
    }
  });
  return reach;
}

}  // namespace softfocus

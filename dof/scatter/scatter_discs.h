#pragma once
// The discs of scatter.h, as spans.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "raster/threads/parallel.h"

namespace softfocus {

/// One row of a disc about x. Pixels x - whole to x + whole are covered fully, the next on
/// either side by `eighths`. If whole is -1, both of these are the pixel x, covered by
/// 2 eighths - 8 eighths. If it is -2, the disc does not reach the row.
struct DiscSpan {
  std::int16_t whole;
  std::int16_t eighths;  ///< 0 to 7
};

struct ScatterDiscs {
  int count;                    ///< of discs; their radii are 0, 1/4, 1/2, ... pixels
  int reach;                    ///< the largest disc's rows above and below its centre
  std::vector<DiscSpan> spans;  ///< |dy| = 0, 1, ... : the spans of all discs at |dy|
  std::vector<int> reaches;     ///< each disc's rows above and below its centre
  std::vector<float> weights;   ///< each disc's 1 / sum of its coverages
};

/// Discs up to a radius, 0 to kLargestMaxCoc. With `used` only those of the discs that it has a 1
/// for; the others reach no row but their own.
ScatterDiscs make_discs(float largest_px, std::span<const std::uint8_t> used = {});

/// The number of the disc for a radius, which may be negative.
inline int disc_of(float radius_px) {
  return static_cast<int>((radius_px < 0.0f ? -radius_px : radius_px) * 4.0f + 0.5f);
}

/// Light is counted in units of 2^-34. One pixel then gives another at most 65504 * 2^34, below
/// 2^51, and the sum of all light that can meet in a pixel is below 2^55.
inline constexpr float kUnitsOfLight = 0x1p34f;
inline std::uint64_t whole_units(double units) {
  return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::nearbyint(units)));
}

// Tiles of 16x16 pixels, to know which discs can matter where.

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

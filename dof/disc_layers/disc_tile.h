#pragma once
// What disc_layers.cpp and disc_levels.cpp hand to their kernels.

#include <cstddef>
#include <cstdint>

#include "dof/disc_layers/disc_ladder.h"

namespace softfocus {

/// Pixels of a tile, at most.
inline constexpr int kDiscTileWidth = 64;
inline constexpr int kDiscTileHeight = 32;
/// Pixels that rows of a level go on to either side, its last repeated.
inline constexpr int kDiscMargin = 8;
inline constexpr int kDiscTileRow = kDiscTileWidth + 2 * kDiscMargin;
/// Rows above and below that a disc of any rung reaches, and one more.
inline constexpr int kDiscApron = 8;
inline constexpr int kDiscTileRows = kDiscTileHeight + 2 * kDiscApron;

/// Which side of the focus. Before and behind it, the level of whole pixels has squares
/// of radii that are negative nearer than the focus; other levels have them positive.
enum class DiscSide { near, focus, far };

/// Channels of a row of a level's picture, at the same pixel: red, green and blue times
/// weight; weight, the share of the pixel that is there; the square of its radius.
inline constexpr int kDiscWeight = 3, kDiscSquare = 4, kDiscChannels = 5;
struct DiscRow {
  const float* channel[kDiscChannels];
};

/// Rungs of a level that there are on either side, a bit each; larger ones too.
struct MarkedRungs {
  std::uint32_t near, far;
};

/// Two rows of a level, to be one of the next.
struct DiscHalving {
  DiscRow rows[2];
  float sign;  ///< of the squares that count
  RungStep beyond;
  float least_square;  ///< of the next level
  int count;           ///< pixels of the result
  float* to;           ///< its channels, `plane` apart
  std::ptrdiff_t plane;
};

/// A rung to blur in a tile.
struct DiscBlur {
  const DiscRow* rows;  ///< at the tile's first pixel, from `reach + 1` rows above it on
  int width, height;
  DiscSide side;
  float sign;  ///< of the squares of this side
  RungStep begin, end;
  const LadderSpan* spans;
  int reach;
  float area;  ///< the disc's sum where there is 1 everywhere
};

/// What is seen of the rungs so far: colour and transmittance of a tile.
inline constexpr int kDiscTransmitted = 3;
struct DiscTile {
  float channel[4][kDiscTileHeight][kDiscTileWidth];
};

/// Where a rung is blurred.
struct DiscScratch {
  float share[kDiscTileRows][kDiscTileRow];
  float seen[kDiscTileRows][kDiscTileRow];  ///< the share that the rung hides or is
  float product[kDiscTileRows][kDiscTileRow];
  float columns[2][kDiscApron][kDiscTileRow];                  ///< of rows by turns
  float sums[kDiscChannels][kDiscTileHeight][kDiscTileWidth];  ///< discs' sums; last of `seen`
  int seen_sums;  ///< which of the sums are those of `seen`: those of the weight may be the same
};

}  // namespace softfocus

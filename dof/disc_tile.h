#pragma once
// What disc_layers.cpp hands to its kernels.

#include <cstddef>

#include "dof/disc_ladder.h"

namespace softfocus {

/// Pixels of a tile, at most.
inline constexpr int kDiscTileWidth = 64;
inline constexpr int kDiscTileHeight = 32;
/// Pixels that rows of a level go on to either side, its last repeated.
inline constexpr int kDiscMargin = 16;

/// Which side of the focus. Before and behind it, the level of whole pixels has squares
/// of radii that are negative nearer than the focus; other levels have them positive.
enum class DiscSide { near, focus, far };

/// Rows of a level's picture at the same pixel: red, green, blue times weight, `plane`
/// apart; the share of the pixel that is there; the square of its radius.
struct DiscRows {
  const float* colour;
  const float* weight;
  const float* square;
};

/// Two rows of a level, to be one of the next.
struct DiscHalving {
  DiscRows rows[2];
  std::ptrdiff_t plane;
  float sign;  ///< of the squares that count
  RungStep beyond;
  float least_square;  ///< of the next level
  int count;           ///< pixels of the result
  float* to;           ///< its colour, weight and square
  std::ptrdiff_t to_plane;
};

/// A rung to blur in a tile.
struct DiscBlur {
  const DiscRows* rows;  ///< at the tile's first column, from `reach` rows above it on
  std::ptrdiff_t plane;
  int width, height;
  DiscSide side;
  float sign;  ///< of the squares of this side
  RungStep begin, end;
  const LadderSpan* spans;
  int reach;
};

/// What is seen of the rungs so far: planes of a tile.
struct DiscTile {
  float red[kDiscTileHeight][kDiscTileWidth];
  float green[kDiscTileHeight][kDiscTileWidth];
  float blue[kDiscTileHeight][kDiscTileWidth];
  float transmitted[kDiscTileHeight][kDiscTileWidth];
};

/// Of a rung: discs' sums of its colour and share, and of the share that it hides or is.
struct DiscSums {
  float sums[5][kDiscTileHeight][kDiscTileWidth];
};

}  // namespace softfocus

#pragma once
// A lens view in tiles, as it is drawn, its depths sorted into levels.

#include <cstdint>
#include <vector>

#include "raster/images/image.h"
#include "raster/lanes/isa.h"
#include "scenes/filtered_views/view_spread.h"

namespace softfocus {

/// The side of a tile, that of the rasterizer.
inline constexpr int kSpreadTile = 64;

/// A view as it is drawn: tile after tile, each RGBA16F in rows without gaps.
struct ViewTiles {
  int width = 0, height = 0;  ///< of the picture
  int tiles_x = 0, tiles_y = 0;
  RowMemory<std::uint16_t> halves;
  /// The nearest and the farthest level of each tile, from 0.
  struct Levels {
    std::uint16_t nearest, farthest;
  };
  std::vector<Levels> levels;
};

ViewTiles make_view_tiles(int width, int height);
std::uint16_t* texels_of_tile(const ViewTiles& view, int tile);

/// Puts levels, counted from 0, in place of the depths of a tile that has been drawn.
void set_levels(ViewTiles& view, const ViewSpread& spread, int tile, Isa isa);

/// Pixels of a tile, less at the picture's right and lower edge.
int tile_width(const ViewTiles& view, int tile_x);
int tile_height(const ViewTiles& view, int tile_y);

}  // namespace softfocus

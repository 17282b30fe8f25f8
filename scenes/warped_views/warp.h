#pragma once
// A picture of the scene from one point of the lens, warped to another point.
//
// Seen from the lens's point p (in radii of the aperture, x to the right, y up), what has a circle
// of signed radius r lies r p from where the pinhole sees it. So from q it lies r (q - p) from
// where it is in the picture from p. It is put there to the next whole pixel, where the nearest of
// all that come is seen: the radius grows with the depth, so it tells what is nearer, too. The
// colour is then read, bilinearly, from where in the source exactly the pixel's centre comes from.
//
// Where neighbours move apart by one pixel the farther of the two fills the pixel between: else a
// surface that is stretched would have cracks.

#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "raster/lanes/isa.h"
#include "raster/pipeline/state.h"
#include "scenes/warped_views/warp_source.h"

namespace softfocus {

/// Parts of a pixel that are not worth reading the next texel for.
inline constexpr float kWholePx = 1.0f / 64.0f;

/// Where an area of the warped picture comes from. Its rows have kTileBorder columns on both sides.
struct WarpTile {
  Rectangle area;
  std::vector<float> radii;          ///< +infinity where nothing came to
  std::vector<std::int32_t> places;  ///< y << 16 | x in the source; kNoPlace
};
inline constexpr std::int32_t kNoPlace = -1;
inline constexpr int kTileBorder = 16;

inline int place_x(std::int32_t place) { return place & 0xFFFF; }
inline int place_y(std::int32_t place) { return place >> 16; }

inline int tile_stride(const WarpTile& tile) {
  return tile.area.x_end - tile.area.x_begin + 2 * kTileBorder;
}
inline std::size_t tile_at(const WarpTile& tile, int x, int y) {
  return static_cast<std::size_t>((y - tile.area.y_begin) * tile_stride(tile) + kTileBorder + x -
                                  tile.area.x_begin);
}

/// Pixels by which a circle of radius 1 moves from the source's point to `point`, y downwards.
glm::vec2 warp_shift(const WarpSource& source, glm::dvec2 point);

/// Whole pixels, halves away from 0.
inline int whole_shift(float shift_px) {
  return static_cast<int>(shift_px + (shift_px < 0.0f ? -0.5f : 0.5f));
}

/// Fills the tile. The bits are the same for any vector unit and any tile.
void warp_to(const WarpSource& source, glm::vec2 shift, const Rectangle& area, WarpTile& tile,
             Isa isa);

/// Sums of colours, with the rows of a tile.
struct WarpedColours {
  std::vector<float> red, green, blue;
};

/// Adds the tile's colours, but where nothing came to. Returns whether there are such pixels.
bool add_colours(const WarpSource& source, glm::vec2 shift, const WarpTile& tile,
                 WarpedColours& sums, Isa isa);

}  // namespace softfocus

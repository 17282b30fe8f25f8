#pragma once
// A picture of the scene from one point of the lens, warped to another point.
//
// Seen from the lens's point p (in radii of the aperture, x to the right, y up), what has a circle
// of signed radius r lies r p from where the pinhole sees it. So from q it lies r (q - p) from
// where it is in the picture from p. It is put there to the next whole pixel, where the nearest of
// all that come is seen: the radius grows with the depth, so it tells what is nearer, too. And it
// tells the way back, so a pixel keeps nothing else: warped_colours.h reads its colour.
//
// Where neighbours move apart by one pixel the farther of the two is put once more, beside itself:
// else a surface that is stretched would have cracks.

#include <bit>
#include <cstdint>
#include <glm/vec2.hpp>
#include <limits>
#include <span>
#include <vector>

#include "raster/lanes/isa.h"
#include "raster/pipeline/state.h"
#include "scenes/warped_views/warp_source.h"

namespace softfocus {

/// Notes of a pixel between neighbours that moved apart: from where its radius leads, the pixel
/// that it is of lies one to the left, to the right, above or below.
inline constexpr std::uint32_t kLeftOf = 2, kRightOf = 3, kAbove = 4, kBelow = 5;

/// Where an area of the warped picture comes from. Its rows have kTileBorder columns on both sides.
struct WarpTile {
  Rectangle area;
  std::vector<float> radii;  ///< noted; kHoleRadius where nothing came to
  std::vector<std::int32_t> places_of_holes;
  std::size_t hole_count = 0;
};
inline constexpr float kHoleRadius = std::numeric_limits<float>::infinity();
inline constexpr int kTileBorder = 16;

inline int tile_stride(const WarpTile& tile) {
  return tile.area.x_end - tile.area.x_begin + 2 * kTileBorder;
}
/// y << 16 | x of the pixels that nothing came to, row by row.
inline std::span<const std::int32_t> holes_of(const WarpTile& tile) {
  return {tile.places_of_holes.data(), tile.hole_count};
}
inline std::size_t tile_at(const WarpTile& tile, int x, int y) {
  return static_cast<std::size_t>((y - tile.area.y_begin) * tile_stride(tile) + kTileBorder + x -
                                  tile.area.x_begin);
}

/// Pixels by which a circle of radius 1 moves from the source's point to `point`, y downwards.
glm::vec2 warp_shift(const WarpSource& source, glm::dvec2 point);

/// To the nearest whole number, ties to even; up to 2^22. In a sum with 1.5 2^23 the last bit
/// counts 1.
inline constexpr float kWholeSum = 0x1.8p23f;
inline constexpr std::int32_t kWholeSumBits = 0x4B400000;
inline int nearest_whole(float value) {
  return std::bit_cast<std::int32_t>(value + kWholeSum) - kWholeSumBits;
}

/// The pixel of a source that a warped pixel shows. `radius` is noted, and no hole's.
struct SourcePixel {
  int x, y;
};
SourcePixel shown_pixel(glm::vec2 shift, int x, int y, float radius);

/// Fills the tile's radii; add_colours() lists its holes. The bits are the same for any
/// vector unit and any tile.
void warp_to(const WarpSource& source, glm::vec2 shift, const Rectangle& area, WarpTile& tile,
             Isa isa);

}  // namespace softfocus

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
#include <span>
#include <vector>

#include "dof/lens.h"
#include "raster/images/image.h"
#include "raster/lanes/isa.h"
#include "raster/pipeline/state.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// The side in pixels of the blocks of a source that are warped or passed over.
inline constexpr int kWarpBlock = 32;

/// Circles count as no larger than this.
inline constexpr float kMostWarpRadiusPx = 1024.0f;

/// What is farther aside than this, in pixels of the warp, is another surface.
inline constexpr float kSameSurfacePx = 0.75f;

/// Parts of a pixel that are not worth reading the next texel for.
inline constexpr float kWholePx = 1.0f / 64.0f;

/// A picture that was drawn, as planes of binary32. Each has a border that repeats the outermost
/// pixels, of one row and kSourceBorder columns: plane_at() has the place of a pixel.
struct WarpSource {
  glm::dvec2 point{0.0};  ///< of the lens
  int width = 0, height = 0;
  std::vector<float> red, green, blue;
  std::vector<float> radii;        ///< signed, in pixels
  std::vector<float> block_radii;  ///< the largest |radius| of each block, row by row
};
inline constexpr int kSourceBorder = 16;

inline int plane_stride(const WarpSource& source) { return source.width + 2 * kSourceBorder; }
inline std::size_t plane_at(const WarpSource& source, int x, int y) {
  return static_cast<std::size_t>((y + 1) * plane_stride(source) + kSourceBorder + x);
}

/// How much reading between texels blurs, to be taken away beforehand. At a part f from a texel the
/// variance along an axis is f (1 - f) square pixels. The colour c of a pixel whose circle is r
/// becomes c + sum over its four neighbours n of v(r) / 2 (c - n), with v(r) the mean variance of
/// all views of the source: then both together have the variance 0. A difference counts as 1 at
/// most, and as 0 to another surface.
struct WarpSharpening {
  std::vector<float> amounts;  ///< v / 2 at |r| = 0, 1/16, 2/16, ... pixels; the last beyond
  float most_shift = 0.0f;     ///< the largest shift of the views, for a radius of 1
};
inline constexpr float kAmountsAPx = 16.0f;

/// Of the views that are warped by these shifts.
WarpSharpening warp_sharpening(std::span<const glm::vec2> shifts);

/// Fills the planes from RGBA16F with depth in alpha. Depths of 0 and NaN count as nearest. No
/// amounts: the colours stay as they are.
void set_source(WarpSource& source, const Image& picture, const PixelCoc& coc,
                const WarpSharpening& sharpening, ThreadPool& pool);

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

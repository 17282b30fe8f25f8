#pragma once
// A picture as two fields at half resolution, for methods that blur the near one and the far
// one apart: ring-bucket and circular.
//
// 2x2 pixels become one cell. r is a pixel's signed radius in full-resolution pixels.
//
//   t(r) = sat((r^2 - 9/4) / (4 - 9/4))    the share of a pixel that half resolution shows
//   a(r) = max(1/2, sqrt(r^2 - 4) / 2)     the radius, in cells, by which it is still to blur
//
// Half resolution itself, the way back included, has the second moment of a disc of radius 2.
// Smaller circles are blurred at full resolution (merge_fields.h).
//
// Near field: what lies before the focus, n = t(r) if r < 0, else 0.
//   opacity = mean of n;  colour = mean of n c (premultiplied);  size = a(mean of |r| by n)
// Far field: what is left of a pixel, u = 1 - n, blurred or sharp.
//   colour = mean of c by w, w = u max(t(r) if r >= 0, 2^-20);  weight = sum w / sum u
//   size = a(mean of r by w);  seen = mean of u
// So sharp pixels count only where nothing blurred shares the cell, and hardly spread.
//
// Cells that the near field hides are filled from around them (fill_holes.h), with colour, size
// and weight: this is the background behind it. The near field's size is filled likewise, so
// that it goes on outside.

#include <vector>

#include "dof/half_resolution/highlights.h"
#include "dof/picture_planes.h"

namespace softfocus {

/// Planes of HalfFields. The far colour is not premultiplied, the near one is.
inline constexpr int kFarColour = 0, kFarSize = 3, kFarWeight = 4, kFarSeen = 5;
inline constexpr int kNearColour = 6, kNearOpacity = 9, kNearSize = 10;
inline constexpr int kHalfPlanes = 11;

/// The size of a cell that reaches no neighbour.
inline constexpr float kLeastHalfSize = 0.5f;
/// Below this weight a cell shows only what is sharp, or almost.
inline constexpr float kSharpWeight = 0x1p-20f;

struct HalfFields {
  Planes cells;
  bool near_field;  ///< whether any cell has an opacity above 0
  Highlights highlights;
};

/// The fields without the picture's highlights, which are apart: discs, or polygons of so many
/// corners, 3 or more.
HalfFields make_half_fields(const DofInput& input, ThreadPool& pool, int corners = 0);

/// A cell from its four pixels, row by row: what the kernel computes, for the tests and for
/// cells that have lost a highlight. `to[i]` for each plane.
void half_cell(const SplitTexel* four, float* to);

/// Square tiles of cells, and how far what is in them reaches.
inline constexpr int kHalfTile = 16;
struct HalfTiles {
  int columns, rows;
  /// For each tile the largest size that reaches it from any tile, at least kLeastHalfSize: of
  /// the far field, and of the near one, 0 if that does not reach it. The near field's tiles
  /// are so dilated by what is in them.
  std::vector<float> far_reach, near_reach;
  /// The least size of the far field in the tiles that far_reach may come from.
  std::vector<float> far_least;

  std::size_t at(int column, int row) const {
    return static_cast<std::size_t>(row * columns + column);
  }
};
/// With `stretch` more than 1 sizes reach further by that. If cells gather over their own size,
/// a tile is reached also if its own cells reach.
HalfTiles make_half_tiles(const HalfFields& fields, float stretch, bool gathers, ThreadPool& pool);

}  // namespace softfocus

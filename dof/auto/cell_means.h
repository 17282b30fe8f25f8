#pragma once
// The means of a picture's cells of 8x8 pixels: colour in linear light and radius of the circle
// of confusion; and the brightest that is out of focus. A lamp of a pixel, which a sparse sample of
// pixels would miss, is in the mean of its cell with all of its light.

#include <array>
#include <vector>

#include "dof/lens.h"
#include "raster/images/image_view.h"
#include "raster/threads/parallel.h"

namespace softfocus {

inline constexpr int kCellPx = 8;
inline constexpr float kLargestTraitRadiusPx = 1024.0f;

struct CellMean {
  std::array<float, 3> colour{};  ///< linear, 0 to 65504
  float radius_px = 0.0f;         ///< signed, negative nearer than the focus
  float brightest = 0.0f;         ///< channel of the pixels with a radius of half a pixel or more
};

struct CellMeans {
  int columns = 0;
  int rows = 0;
  std::vector<CellMean> cells;  ///< row by row; the last of a row or column may be smaller
};

/// Of an RGBA16F picture with depth in alpha. A negative or NaN colour counts as 0, an infinite
/// one as 65504; radii as in signed_trait_radius(). A cell's columns are summed from above, then
/// from the left, in binary32: the same bits for any number of threads and every vector unit.
CellMeans cell_means(const ConstImageView& picture, const PixelCoc& coc, ThreadPool& pool);

/// Cut to a magnitude of kLargestTraitRadiusPx; a depth that is NaN or infinite lies beyond the
/// focus, one of 0 before it.
float signed_trait_radius(const PixelCoc& coc, float depth_m);

/// Light as a sum takes it: 0 to 65504.
float trait_light(float value);

}  // namespace softfocus

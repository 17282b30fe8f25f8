#pragma once
// A picture as planes of floats, for methods that filter it several times or in layers.
//
// A NaN colour becomes black and an infinite one the largest half, so that neither spreads
// through sums that reach far.

#include <cstddef>
#include <vector>

#include "dof/dof.h"
#include "raster/images/image.h"
#include "raster/lanes/isa.h"

namespace softfocus {

/// Planes of rows of floats. A row begins and ends at a whole vector of the widest unit: methods
/// may read and write the values between `width` and `stride`, which mean nothing.
struct Planes {
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride = 0;  ///< floats from row to row
  std::ptrdiff_t plane = 0;   ///< floats from plane to plane
  RowMemory<float> values;
};

/// Floats from row to row for rows of `width`: a multiple of kMostLanes.
std::ptrdiff_t plane_stride(int width);

/// `count` planes, not initialised, of the pool's memory.
Planes make_planes(int count, int width, int height, ThreadPool& pool);

inline float* plane_row(Planes& planes, int plane, int y) {
  return planes.values.get() + plane * planes.plane + y * planes.stride;
}
inline const float* plane_row(const Planes& planes, int plane, int y) {
  return planes.values.get() + plane * planes.plane + y * planes.stride;
}

/// A pixel with a finite colour.
struct SplitTexel {
  float r, g, b;
  /// The circle of confusion: -max_coc_px to max_coc_px, negative nearer than the focus. A
  /// depth that is infinite or NaN lies behind the focus.
  float radius_px;
};
SplitTexel split_texel(const DofInput& input, int x, int y);

/// Four planes of all pixels' split_texel(): red, green, blue, radius. The last pixel of a
/// row repeats up to the stride.
Planes split_picture(const DofInput& input, ThreadPool& pool);

/// Row `y` of them: `padded` pixels, whole vectors of the widest unit. The last pixel of
/// the row repeats. Planes are `plane` floats apart.
void split_picture_row(const DofInput& input, int y, float* to, std::ptrdiff_t plane, int padded,
                       Isa isa);

/// Stores a row: colours, cut to what a half holds, and the scene's depth in alpha. Needs
/// whole vectors of the unit in `r`, `g` and `b`.
void store_row(const DofInput& input, const ImageView& result, int y, const float* r,
               const float* g, const float* b, Isa isa);

/// Stores `count` pixels of a row from `x` on; r[0] is the colour of pixel `x`.
void store_span(const DofInput& input, const ImageView& result, int x, int y, int count,
                const float* r, const float* g, const float* b, Isa isa);

/// The largest magnitude in each row of a plane.
std::vector<float> largest_of_rows(const Planes& planes, int plane, ThreadPool& pool);

}  // namespace softfocus

#pragma once
// A picture as planes of floats: the form in which methods work that filter it several
// times over, or in more than one layer.
//
// A colour that is NaN counts as black and an infinite one as the largest half, so that
// neither spreads through sums that reach far.

#include <cstddef>
#include <memory>
#include <vector>

#include "dof/dof.h"

namespace softfocus {

/// Planes of rows of floats. A row has room for whole vectors: what lies between the
/// width and the stride is written and read, but means nothing.
struct Planes {
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride = 0;  ///< floats from row to row, a multiple of 16
  std::ptrdiff_t plane = 0;   ///< floats from plane to plane
  std::unique_ptr<float[]> values;
};

/// Planes of nothing in particular.
Planes make_planes(int count, int width, int height);

inline float* plane_row(Planes& planes, int plane, int y) {
  return planes.values.get() + plane * planes.plane + y * planes.stride;
}
inline const float* plane_row(const Planes& planes, int plane, int y) {
  return planes.values.get() + plane * planes.plane + y * planes.stride;
}

/// A pixel, its colour finite.
struct SplitTexel {
  float r, g, b;
  /// Of the circle of confusion: negative nearer than the focus, of a magnitude up to
  /// max_coc_px. A depth that is infinite or NaN lies beyond.
  float radius_px;
};
SplitTexel split_texel(const DofInput& input, int x, int y);

/// split_texel() of every pixel in four planes: red, green, blue, radius. What follows a
/// row's last pixel repeats it.
Planes split_picture(const DofInput& input, ThreadPool& pool);

/// Stores row `y` of colours, cut to what a half holds, with the scene's depth in alpha.
/// There is room for whole vectors in each.
void store_row(const DofInput& input, const ImageView& result, int y, const float* r, const float* g,
               const float* b, Isa isa);

/// The same of `count` pixels from `x` on; the colours are theirs alone.
void store_span(const DofInput& input, const ImageView& result, int x, int y, int count, const float* r,
                const float* g, const float* b, Isa isa);

/// The largest magnitude in each row of a plane.
std::vector<float> largest_of_rows(const Planes& planes, int plane, ThreadPool& pool);

}  // namespace softfocus

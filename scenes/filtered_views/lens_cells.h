#pragma once
// The lens cut into cells: a view looks from each, and stands for all of it.

#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "scenes/lens_views/lens_points.h"

namespace softfocus {

/// Cells of equal area, each as `per_cell` points, in radii of the aperture.
struct LensCells {
  std::vector<glm::dvec2> views;   ///< where each cell's view looks from
  std::vector<glm::dvec2> points;  ///< cell by cell, as offsets from the view
  int per_cell = 1;
  std::vector<glm::dvec2> in_pixel;  ///< where in the pixel each view looks: view_offsets()
};

/// The most points that a cell has.
inline constexpr int kMostCellPoints = 32;

/// Points of a cell for a picture of so many views: 32 up to 8 views, 16 up to 32, and 1 beyond: a
/// cell is its view.
int points_of_cell(int views);

/// The views are lens_points_for() their number, and the points those for `views` * `per_cell`,
/// each given to a view such that no exchange of two brings them nearer to theirs. So both the
/// views and the points have the lens's middle and size: nothing out of focus moves or changes its
/// size, whether a view stands for its cell or for itself.
LensCells lens_cells(ApertureShape shape, int views, int per_cell, bool jitter = false);

/// The longest step of a cell's rays, in pixels, below which they are better left alone: the mean
/// of the views is smooth there, and whole pixels would only add noise. 0.5 up to 8 views, 1.3 up
/// to 16, 1.5 beyond. With these bounds every scene of docs/methods.md is as near to the truth as
/// with unfiltered views, to within 2 %. With jitter a step's rounding is the pixel's own
/// width, and the bound is 0.5 and 0.65.
double least_step_px(const LensCells& cells);

/// The offsets of a cell's points.
std::span<const glm::dvec2> points_of(const LensCells& cells, int cell);

}  // namespace softfocus

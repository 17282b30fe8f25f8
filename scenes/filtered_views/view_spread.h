#pragma once
// A lens view spread over its cell of the lens: pictures from the cell's other points, guessed from
// the view and its depths, and averaged.
//
// Seen from a point that lies (x, y) beside the view's own, in radii of the aperture, a thing
// whose circle of confusion has the signed radius r (dof/lens.h) lies (x r, -y r) pixels beside its
// place in the view. So a pixel p of the picture from there, a ray through that point of the lens,
// shows the nearest q with q + (x r_q, -y r_q) = p: a light field from one picture with depth, as
// Yu, Wang and Yu 2010 make it, and the depth test that Shinya 1994 has for each point of the lens.
//
// To find q, things are sorted by radius into levels, and looked for level by level, from the
// nearest:
//
//   level(q) = round(a r_q / (1 + b |r_q|)),  from -L to L, the farther ones in the last
//   q_j = p - round'(r_j (x, -y)),  r_j the radius of level j;
//   the first j with level(q_j) = j gives q
//   round'(v) = floor(|v| + t), 0 if that is less, with the sign of v
//
// Pixels are whole, and a circle may have one. So t, of each level and axis, is such that the
// steps of all views together have the mean square that they have before they are rounded: a
// circle keeps its size. t = 1/2 would make one of a pixel too small, one of two too large.
//
// A view that looks beside its pixels' centres, at o, shows what lies at q + o. So a ray's step is
// round'(r_j (-x, y) - o), around the centre, and the steps' mean square has a pixel's in it, 1/12.
// Where no ray moves, the views' own places smooth what is in focus.
//
// Levels lie 2/3 of a pixel apart in focus, where all steps are 0, and the farther from it the
// more: none moves a ray by much more than a pixel. Pixels outside the picture are those of its
// edge.
//
// What the ray sees and the view does not is guessed: no level holds it. There something near
// has moved away, so p shows what lies beside it: q_j of p's own level if that is farther than p,
// else p itself. That also closes the gaps that open in a surface between two levels. (To close
// them by taking what lies between q_(j-1) and q_j lets leaves and bars grow: with 8 views of
// foliage mean FLIP is .017, and .015 without.)
//
// Where the longest step is below least_step_px() no ray moves: there the mean of the views is
// smooth as it is, and whole pixels only add noise.
//
// Known failures: what is hidden is a guess; r beyond that of the last level counts as that, so
// light of larger circles is left in as many spots as there are views; rays end in whole pixels,
// which is noise in small circles and in highlights; something transparent moves with what it is
// seen at.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "dof/lens.h"
#include "raster/images/image_view.h"
#include "scenes/filtered_views/lens_cells.h"

namespace softfocus {

/// A ray's largest step in pixels, in each direction.
inline constexpr int kMostSpreadStep = 32;

struct ViewSpread {
  PixelCoc coc;
  float levels_per_px = 0.0f;  ///< a
  float bend_per_px = 0.0f;    ///< b
  /// r_j in pixels, j from 0 to kMostSpreadLevel.
  std::vector<double> radius_px;
  /// t of round'() for the levels j and -j: along x, and along y.
  std::array<std::vector<double>, 2> rounding;
};

inline constexpr int kMostSpreadLevel = 63;  ///< L
inline constexpr int kSpreadLevels = 2 * kMostSpreadLevel + 1;

/// For all cells of a lens.
ViewSpread make_view_spread(const PixelCoc& coc, const LensCells& cells);

/// The level of a depth in metres. What is infinite or NaN lies behind the focus.
int spread_level(const ViewSpread& spread, float depth_m);

struct PixelStep {
  int x = 0, y = 0;
};

/// q_j - p of every ray and level: ray by ray, kSpreadLevels each. The view looks at `in_pixel`,
/// to the right and down from its pixels' centres.
std::vector<PixelStep> ray_steps(const ViewSpread& spread, std::span<const glm::dvec2> points,
                                 glm::dvec2 in_pixel = glm::dvec2{0.0});

/// Red, green and blue of a picture, planes one after the other.
using ColourPlanes = std::vector<float>;

/// The mean of a view's rays, by the definition: a pixel after the other, each ray through all
/// levels. The rays' colours are added in binary32 in their order, and divided by their number,
/// a power of two.
ColourPlanes spread_view_oracle(const ConstImageView& view, const ViewSpread& spread,
                                std::span<const PixelStep> steps, int rays);

}  // namespace softfocus

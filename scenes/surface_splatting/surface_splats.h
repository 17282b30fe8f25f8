#pragma once
// A scene's surfaces as splats: points with a colour, a place, and the area that each stands for.
//
// Points are taken where the pinhole's rays meet the surfaces, all of them, hidden ones too: so
// they are evenly dense on the screen and their footprints there are round. (Points that are
// even on the surface have elliptic footprints, and a density that no view agrees with.) A pixel
// in focus has one point on each surface that it sees or that is behind.
//
// Level of detail by the lens (Krivanek, Zara and Bouatouch 2003): a blurred surface needs fewer
// points. A cell of s x s pixels, s = 2^k the largest up to r / 3, is one point: the mean of
// those in it, shaded once, with textures at the cell's level of detail. Points of one object in
// a cell join if their circles are alike to an eighth and the cell is not full. A thing
// thinner than a cell is a point of a small area, so nothing is missed.
//
// A point that no point of the lens sees is left out: behind what the pinhole sees there, by more
// than the error of its halves, and behind all that lies as near as the two circles' difference
// reaches. Without this a floor under a rug would show through it: the floor's nearer points come
// before the rug's farther ones.
//
// What only the lens's rim sees, and not its centre, has no points: surfaces turned away from the
// centre.

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "raster/threads/parallel.h"
#include "scenes/lens_views/lens_view_method.h"

namespace softfocus {

struct Splat {
  float x_px, y_px;       ///< from the picture's corner; a pixel's centre is at 0.5
  float inverse_depth;    ///< 1 / metres
  float radius_px;        ///< of the circle of confusion, 0 or more
  float area_px;          ///< that it stands for: 1, or up to s^2 if s > 1
  std::uint32_t surface;  ///< the number of its object
  glm::vec3 colour;
};

/// The side s in pixels of the cell for a circle: 1 or a power of two.
int splat_cell_px(float radius_px);
inline constexpr int kLargestSplatCell = 64;

/// How far a splat's image reaches: 3 standard deviations, with r / 2 each, and a pixel.
inline float splat_reach_px(float radius_px) { return 1.55f * radius_px + 1.0f; }

/// All that reach the picture, in an order that does not depend on threads. Radii are cut to
/// kLargestMaxCoc.
std::vector<Splat> surface_splats(const LensViewInput& input, ThreadPool& pool);

}  // namespace softfocus

#pragma once
// Simulated diffusion in layers, after Kass, Lefohn and Owens 2006: colour is heat, which flows
// where circles of confusion are large. What is blurred behind the focus is a layer, what is
// blurred before it another. So a blurred background passes behind sharp things, and a blurred
// foreground spreads over them.
//
// A layer has the pixels of circles above half a pixel on its side of the focus. Inside, colour
// c and opacity 1 are heat; outside there is none. Each line, first rows, then columns, is a
// tridiagonal system for colour and one for opacity,
//
//   (1 + b_(i-1/2) + b_(i+1/2)) x_i - b_(i-1/2) x_(i-1) - b_(i+1/2) x_(i+1) = heat_i
//   b_(i+1/2) = min(b_i, b_(i+1)), 0 at the picture's borders;   b_i = R_i^2 / 8
//   R_i = |r_i| inside; outside the largest |r_j| - |i - j| / 8 of the line
//
// R continues the layer's circles over what is not in it; columns continue what rows did. The
// kernel is exp(-|x| / sqrt(b)), of variance 2 b = r^2/4 along an axis, which is that of a disc.
//
// C, A: colour and opacity of a layer after both directions.
//   far pixel:   G = C_far / A_far, what is hidden left out
//   other pixel: G = its own colour
//   near pixel:  C_near + H, where H is G of all but near pixels, diffused like C_near: what
//                shows through a foreground's edge is guessed from its surroundings
//   other pixel: C_near + (1 - A_near) G
//
// Solved by elimination, in a form that never subtracts, from the line's end to its start and
// back:
//   t_i = 1 + b_(i+1/2) t_(i+1) / g_(i+1),  g_i = t_i + b_(i-1/2)
//   d_i = (heat_i + b_(i+1/2) d_(i+1)) / g_i,  x_i = d_i + b_(i-1/2) / g_i x_(i-1)
// The cost does not depend on the radius. A layer without pixels costs nothing, and neither do
// lines that a layer does not reach.
//
// Rejected: two steps of half the time in each direction, which take the cusp off the kernel.
// They lower the error by a tenth and cost a third more. And more than two layers, which let a
// foreground spread over something less blurred: three on each side lower the mean
// error by an eighth, and each costs more than the near layer.
//
// Known failures: a point becomes a peak with a star's tails, not a disc; a layer is one, so
// something less blurred blocks the blur of what is behind it on the same side of the focus;
// the background behind a near thing is a blur of what surrounds it.

#include <cmath>

#include "dof/dof.h"

namespace softfocus {

/// b_i of a pixel's own radius.
inline float heat_flow(float radius_px) {
  return std::fabs(radius_px) > 0.5f ? radius_px * radius_px * 0.125f : 0.0f;
}

/// A Method's apply (dof.h).
void diffusion(const DofInput& input, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus

#pragma once
// Simulated diffusion, after Kass, Lefohn and Owens 2006: colour is heat, which flows where
// circles of confusion are large. One implicit step along rows, then one along columns.
// Each line is a tridiagonal system,
//
//   (1 + b_(i-1/2) + b_(i+1/2)) x_i - b_(i-1/2) x_(i-1) - b_(i+1/2) x_(i+1) = c_i
//   b_(i+1/2) = min(b_i, b_(i+1)), 0 at the picture's borders;   b_i = r_i^2 / 8
//
// For constant b its kernel is exp(-|x| / sqrt(b)), of variance 2 b = r^2/4 along an axis,
// which is that of a disc. The matrix is symmetric and its rows sum to 1, so the sum of all
// light stays. A pixel with no circle keeps its colour exactly and lets no other through.
//
// Solved by elimination, in a form that never subtracts:
//   t_i = 1 + b_(i-1/2) t_(i-1) / g_(i-1),  g_i = t_i + b_(i+1/2)
//   d_i = (c_i + b_(i-1/2) d_(i-1)) / g_i,  x_i = d_i + b_(i+1/2) / g_i x_(i+1)
// The cost does not depend on the radius.
//
// Circles up to a radius of half a pixel count as none.
//
// Known failures: a point becomes a star with a peak and long tails, not a disc; a blurred
// foreground ends hard before something sharp (min takes the sharp one's b); blurred things
// on either side of a sharp line do not mix.

#include "dof/dof.h"

namespace softfocus {

/// A Method's apply (dof.h).
void diffusion(const DofInput& input, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus

#pragma once
// Simulated diffusion, after Kass, Lefohn and Owens 2006: colour is heat that flows
// where circles of confusion are large. One implicit step along rows, and one along columns
// of what that gives; each line is a tridiagonal system,
//
//   (1 + b_(i-1/2) + b_(i+1/2)) x_i - b_(i-1/2) x_(i-1) - b_(i+1/2) x_(i+1) = c_i
//   b_(i+1/2) = min(b_i, b_(i+1)), 0 at the picture's borders;   b_i = r_i^2 / 8
//
// whose kernel for constant b is exp(-|x| / sqrt(b)), of variance 2 b: r^2/4 an axis,
// which is a disc's. The matrix is symmetric with rows that sum to 1: light is kept, and a
// pixel with no circle keeps its colour exactly and lets none through.
//
// Solved by elimination, written so that nothing is subtracted:
//   t_i = 1 + b_(i-1/2) t_(i-1) / g_(i-1),  g_i = t_i + b_(i+1/2)
//   d_i = (c_i + b_(i-1/2) d_(i-1)) / g_i,  x_i = d_i + b_(i+1/2) / g_i x_(i+1)
// The cost is the same whatever the radius.
//
// Circles up to a radius of half a pixel count as none.
//
// Known failures: a point becomes a peak with long tails, star-shaped, not a disc; a
// blurred foreground ends hard where it lies before something sharp (min takes the sharp
// one's b), and blurred things on either side of a sharp line do not meet.

#include "dof/dof.h"

namespace softfocus {

void diffusion(const DofInput& input, const ImageView& result, ThreadPool& pool);

/// The oracle of diffusion, line by line; equal to the bit.
void diffusion_plain(const DofInput& input, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus

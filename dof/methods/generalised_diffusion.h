#pragma once
// Generalised depth of field, after Kosloff and Barsky 2007: diffusion with a field of blur that
// the user gives, pixel by pixel, so that several depths or objects can be sharp at once. No
// lens need be able to make the picture.
//
// The field is DofInput::radii_px, cut to max_coc_px; without one it is the lens's circles of
// confusion. A radius's sign does not matter. Colour is heat, which flows where radii are
// large: one implicit step along rows, then one along columns. Each line is a tridiagonal
// system,
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
// The paper blurs a sequence of layers. Here the picture is one: where blur is a user's wish,
// there is no lens that would say what shows behind an edge.
//
// Known failures: a point becomes a star with a peak and long tails, not a disc; a blurred
// foreground ends hard before something sharp (min takes the sharp one's b); blurred things
// on either side of a sharp line do not mix.

#include "dof/dof.h"

namespace softfocus {

/// A Method's apply (dof.h).
void generalised_diffusion(const DofInput& input, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus

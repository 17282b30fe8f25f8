#pragma once
// Anisotropic diffusion, after Bertalmio, Fort and Sanchez-Crespo 2004: colour is heat, and the
// equation is stepped through time on the picture's pixels,
//
//   I_t = div(b grad I),   b = r^2/8 over a time of 1
//
// since a disc has a variance of r^2/4 along an axis. Between two pixels flows min(b_i, b_j)
// times their difference; nothing flows over the picture's borders. All light is kept, and a
// pixel in focus keeps its colour to the bit and lets no other through.
//
// The authors take explicit steps, each stable up to a time of 1 / (4 b): r^2/2 of them, 2048 at
// a radius of 64. Here all is one super step of s stages (Alexiades, Amiez and Gremaud 1996), in
// the recurrence of Gegenbauer's polynomials with index 3/2 (Skaras et al. 2021). With L the sum
// of a pixel's four flows,
//
//   I_1 = I_0 + w L I_0,   w = 4 / (s^2 + 2 s - 1)
//   I_k = I_(k-1) + m (I_(k-1) - I_(k-2)) + (1 + m) w L I_(k-1),   m = (k - 1) / (k + 2)
//   result = (I_(s-1) + I_s) / 2
//
// It is stable for s^2 + 2 s - 1 >= 2 r^2 of the largest r, which makes s about sqrt(2) r: 90 at
// 64. The mean of two stages removes the chequer that single stages have, since at each light
// moves by one pixel.
//
// The index is chosen for its kernel. For constant b a stage is I_0 under the polynomial
// C_s(1 + w L) / C_s(1). For many stages it tends to 2 J1(r |k|) / (r |k|) at a wave vector k,
// which is the transform of a disc of radius r. Steps that follow the equation closely give
// its own kernel, a Gaussian. Legendre's polynomials, index 1/2, are the usual choice and would
// give J0: a ring.
//
// A tile takes twelve stages at a time, with twelve pixels around it that are lost one a stage, so
// that it stays in the cache. Tiles without a blurred pixel are left out. The cost grows with
// the largest radius in the picture.
//
// Circles up to a radius of half a pixel count as none.
//
// Known failures: a blurred foreground ends hard before something sharp, since min takes the
// sharp one's b; blur does not pass a sharp line; where b changes, the blur is no disc; a point
// keeps a bright pixel in the middle of its disc.

#include "dof/dof.h"

namespace softfocus {

/// A Method's apply (dof.h).
void anisotropic_diffusion(const DofInput& input, const ImageView& result, ThreadPool& pool);

/// Its oracle and scalar form: the whole picture stage by stage. Equal to the bit.
void anisotropic_diffusion_oracle(const DofInput& input, const ImageView& result, ThreadPool& pool);

/// The stages for a largest radius; 0 if nothing is blurred.
int diffusion_stages(float largest_px);

}  // namespace softfocus

#pragma once
// Depth of field by surface splatting, after Krivanek, Zara and Bouatouch 2003: the scene's
// surfaces as points (surface_splats.h), each spread over its circle of confusion by a Gaussian,
// composited from front to back. What lies behind a blurred thing is there, so partial
// occlusion is too.
//
// A disc of radius r has the variance r^2/4 along an axis, a cell of area a has a/12. So at the
// distance (x, y) from a splat
//   w = opacity exp(-(x^2 + y^2) / (2 V)),   V = r^2/4 (- a/12 if a cell has several pixels)
//   opacity = a / (2 pi V): the light of the area spread over the Gaussian
// cut at 3 standard deviations along each axis, with V and the opacity raised by what the cut
// takes. Where the Gaussian is not wider than a few pixels, the opacity is one over its sum
// at the pixels. A splat in focus is its pixel.
//
// Splats of one object exclude each other: through a pixel, each hides a part of the lens of
// its own, and all of an unbroken surface's weights add to 1. Different objects do not know
// of each other: what is open past all is the product of what is open past each. With R_g the
// open part of object g, 1 at first, from front to back at each pixel:
//   t = min(w, R_g)/R_g;  colour += P t splat's colour;  P = P (1 - t);  R_g = R_g - min(w, R_g)
// P is the product of all R_g. At the end colour is divided by 1 - P. The background is an object
// at the far distance.
// (The source's A-buffer blends by depth within a tolerance, as EWA splatting does; at soft
// edges that either lets the background through an unbroken surface or blends two.)
//
// In binary32, splats by 1/depth, then by number, every tile by itself; exp is a polynomial.
//
// Known failures: two surfaces one close above the other mix where the lower is not recognised
// as hidden (surface_splats.h); a Gaussian is not a disc, so lights have no rims; a thing's front
// and back in one object exclude each other too; two edges that hide the same part of the lens
// count as independent; what the lens sees and the pinhole does not, as surfaces turned away;
// highlights are those that the lens's centre sees; the aperture is round. Time and memory grow
// with all that the camera's frustum contains, seen or hidden.

#include <span>

#include "scenes/lens_views/lens_view_method.h"
#include "scenes/surface_splatting/surface_splats.h"

namespace softfocus {

/// The samples of the result are 1. Takes no notice of Sampling.
SampledPicture surface_splatting(const LensViewInput& input, ThreadPool& pool);

/// A picture of splats, over `background`. `surfaces` is more than any Splat::surface. Alpha is
/// that of `depth`, which gives the size.
Image draw_splats(std::span<const Splat> splats, std::uint32_t surfaces, glm::vec3 background,
                  const Image& depth, const Profile& profile, ThreadPool& pool);

/// exp(-t) for t from 0 to 4.5, to 3e-6.
float falling_exponential(float t);

/// A splat's Gaussian.
struct Footprint {
  float inverse_2v;  ///< 1 / (2 V); 0: the pixel that it lies in, and no other
  float opacity;
  float reach_px;  ///< along each axis
};
Footprint footprint_of(const Splat& splat);

}  // namespace softfocus

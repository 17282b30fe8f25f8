#pragma once
// Where the discs of disc_layers.h are centred on slopes.
//
// The ray from a place p through the point v of the lens, in radii of the aperture, sees the pixel
// q with q + v r_q = p. Where r grows by g from pixel to pixel, a step of q is one of (1 - v g) / r
// of the lens; in an even disc it is one of 1 / r. So an even disc gives too much to its side of
// larger radii. As seen from q, the disc of weights 1 - v g has its centre of mass at r g / 4 from
// its own. There, by s, the even disc is centred:
//
//   s = r g / 4 along each axis, at most 1/2
//   g = the slope to the pixel four before, or to that four behind: the lesser of both, 0 if they
//       have not one sign; a slope of 1/2 or more is an outline's and does not count
//   s = 0 if it is below 1/64, |r| <= 1, or r differs by 1/2 or more from that at p -+ 1, where
//       p - s lies
//   colour at p = c_p + |s_x| (c_x - c_p) + |s_y| (c_y - c_p),  c_x, c_y the neighbours there
//
// A pixel keeps its depth. Its light is counted 1 + the change of s from it to the next: over four
// pixels slopes change so little, and halves are rounded so little, that it is within a few per
// cent, an eighth on a sharp ridge.

#include "dof/dof.h"
#include "raster/images/image.h"

namespace softfocus {

/// The picture with its pixels' colours where their discs are centred.
struct CentredDiscs {
  ConstImageView picture;
  RowMemory<std::byte> memory;
};
CentredDiscs centre_discs(const DofInput& input, ThreadPool& pool);

}  // namespace softfocus

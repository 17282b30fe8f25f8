#pragma once
// Where the discs of disc_layers.h are centred on slopes.
//
// The ray from a place p through the point v of the lens, in radii of the aperture, sees the pixel
// q with q + v r_q = p. Where r grows by g from pixel to pixel, a step of q is one of (1 - v g) / r
// of the lens; in an even disc it is one of 1 / r. So an even disc gives too much to its side of
// larger radii. As seen from q, the disc of weights 1 - v g has its centre of mass at r g / 4 from
// its own. There, by s, the even disc is centred:
//
//   s = r g / 4 along each axis, at most 1/2;  g the lesser of the differences to both neighbours
//   s = 0 if it is below 1/64, |r| <= 1, or a difference is 1/2 or more, as at outlines
//   colour at p = c_p + |s_x| (c_x - c_p) + |s_y| (c_y - c_p),  c_x, c_y the neighbours at p - s
//
// A pixel keeps its depth.

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

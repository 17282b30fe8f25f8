#pragma once
// What each pixel may hide: something farther, guessed from the picture around it.
//
//   pyramid  a pixel of a level is the farthest of the 2x2 pixels below it: the mean of those
//            whose radius is within half a pixel of the largest
//   guess    of a pixel with radius r: on the finest level where any of the four pixels around
//            it is farther than r + 1/2, the mean of those that are, by their bilinear
//            weights (9, 3, 3, 1 of 16)
//
// So the guess is the nearest in the picture of all that is farther: behind a wire before a post
// before a wall it is the post.

#include "dof/picture_planes.h"
#include "dof/scatter/scatter_discs.h"

namespace softfocus {

/// Pixels of one surface differ in radius by at most so many pixels from their neighbours.
inline constexpr float kSurfaceStep = 0.5f;

/// What hidden pixels have in place of a radius where there is nothing to hide; more than any
/// radius.
inline constexpr float kNothingBehind = 4096.0f;

struct Behind {
  /// Red, green, blue, radius or kNothingBehind. Without a radius colours mean nothing.
  Planes pixels;
  /// Tiles with pixels that a lens can see past an edge. Others have no guess.
  TileMask seen;
};

/// `scene` is split_picture()'s.
Behind guess_behind(const Planes& scene, ThreadPool& pool);

}  // namespace softfocus

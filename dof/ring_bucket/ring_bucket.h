#pragma once
// Ring-bucket gather, after Abadie 2018: half resolution, near and far field apart, tiles
// that know which circles reach them, taps on rings from the outermost in through prefiltered
// levels, and highlights as sprites.
//
// Fields, highlights and the way back to full resolution are those of dof/half_resolution.
// Sizes a and distances are in cells of half resolution.
//
// 1. Levels. Level 0 is the field itself. A cell of level l is the mean over a square of
//    s = 2^l cells, with half weight at both ends: (1 2 1)/4 for level 1, then the mean of
//    four corners 2^(l-2) cells away. A cell that reaches none of the level's taps is left out:
//    it counts sat(a - T), T = 6 2^(l-1) - s. The mean of a goes by weight, or opacity.
// 2. Taps. Each cell of the plane belongs to one tap: up to distance 6 from the receiver every
//    cell is one, from there to 12 the squares of level 1 are, to 24 those of level 2, and so
//    on. A ring holds the taps of a level whose distance d rounds to the same number of squares.
//    The taps grow with the logarithm of the radius.
// 3. A tap of n cells weighs, by its size a,
//      w = n sat((a - d) / s + 1/2) / A(a),  A(a) = the sum of that over all taps
//    so that a surface of one size keeps its light exactly. A is a table in sixteenths.
//    Far field, ring by ring from outside: taps whose a reaches past the ring's outer border
//    join the bucket `previous`, the others `current`. Then
//      occlusion = sat(mean a of previous - mean a of current)
//      previous = previous (1 - opacity occlusion) + current
//    with opacity = current's sum of n sat(...) over the ring's cells. If all sizes that reach
//    a tile are within 1/4, there is one bucket. Cells with nothing but what is sharp stay.
//    Near field: opacity = sum w o of the cells' opacities o, but at least sum w o / sum w, so
//    that a slope stays opaque; colour = sum w c / sum w o.
//
// Rings are dense, so no median is needed to hide single taps; it would take out thin lines.
//
// The cost is that of the taps: 161 for circles of 16 pixels, 377 for 64, about 110 more for each
// doubling.
//
// Known failures: the background behind a near thing is a guess from around it; half resolution
// doubles the width of anything one pixel wide; outlines of large circles are as soft as the
// squares of their level; a near thing hides no other near thing.

#include "dof/dof.h"

namespace softfocus {

/// A Method's apply (dof.h).
void ring_bucket(const DofInput& input, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus

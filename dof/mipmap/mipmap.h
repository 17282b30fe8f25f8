#pragma once
// Mipmap interpolation, after Lee, Kim and Choi 2009: blur comes from the levels of a mipmap
// pyramid, which a circular filter enlarges. The cost hardly depends on the radius.
//
// Rungs. Blur is made at radii 0, 1, sqrt(2), 2, 2 sqrt(2), ...: those up to sqrt(32) on the
// picture itself, then two on each level, whose pixels are 2, 4, 8, ... across. A pixel between
// two rungs belongs to both, in shares whose mean square is its own. This is the authors'
// nonlinear interpolation between levels: a blend linear in r^2 keeps the second moment of the
// disc. Circles up to half a pixel count as none.
//
// Circular filter. A rung has a filter of up to 13x13 pixels of its level, a disc with a soft
// edge, so that enlarging draws no boxes. Halving by means of 2x2 and enlarging by (1 3) / 4 have
// (1 - 4^-level) / 3 of a level's pixel as variance along an axis; the filter has the rest of
// the r^2/4 of a disc.
//
// Anisotropic mipmap. A pixel goes up to the next level in the share by which its circle is
// larger than the level's, C' = mean(share C), W' = mean(share W): what is sharper than a level
// is not in it, so it cannot leak into what is more blurred. Before and behind the focus are two
// pyramids.
//
// Before the focus. The picture behind is known only outside near things. Its holes are filled
// from its own pyramid (push and pull): downwards means weighed by what is there, upwards
//
//   filled = mix(enlarged filled of the next level, C / W, min(1, 4 W))
//
// Depth is filled with it. So a thin or soft near thing shows what is around it, where the
// authors blur the map of circles to spread near things outwards.
//
// Composition, from the nearest rung to the farthest: with K the rung's filter and s its shares,
// the opacity is (K s) / (K v), v being s and all that it hides. Colours add behind what is seen
// so far; the levels are composited from the largest, and enlarged each into the next.
//
// Against the article: it has one blur for a pixel by its smoothed circle, from the two levels
// about it; here a pixel's light is spread by its own circle, which ends nothing hard.
//
// Known failures: what is behind something near is continued, not known; something near that
// is hidden by something nearer is continued only by its own circle, so its outline shows; a
// circle between two rungs is two discs; levels of 8 and more have soft discs, which lie up to
// half a level's pixel beside their place.

#include "dof/dof.h"

namespace softfocus {

/// A Method's apply (dof.h).
void mipmap(const DofInput& input, const ImageView& result, ThreadPool& pool);

/// The oracle of mipmap(), and its scalar form: whole levels, pixel by pixel. Equal to the bit.
void mipmap_oracle(const DofInput& input, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus

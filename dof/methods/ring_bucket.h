#pragma once
// Ring-bucket gather, after Abadie 2018: half resolution, tiles that know which circles reach
// them, taps on rings from the outermost in, and the near field by itself.
//
// 1. 2x2 pixels become one, with the signed radius r (in full-resolution pixels) of the
//    nearest and the mean colour of those whose radius is within a pixel of it. Half
//    resolution itself, interpolation included, has the second moment of a disc of radius 2.
//    A tap has to spread a pixel over what is missing, a disc of the size, in half-resolution
//    pixels,
//      a = max(1/2, sqrt(r^2 - 4) / 2)
//    Half resolution shows the share t(r) = sat((r^2 - 1/4) / (4 - 1/4)) of a pixel.
// 2. Each tile of 16x16 has K, the largest a that reaches it from any tile, rounded up to
//    quarters. Its taps lie on n = ceil(K) rings, 1 to 5. Ring i has the radius i s pixels,
//    s = max(K/n, 1), and 8 i taps, rounded to pixels: 9 to 121 taps in all.
// 3. A sample p at distance d weighs
//      w = sat(a - d + 1/2) / max(1, a^2 D),   D = taps / ((n + 1/2) s)^2
//    A share t of a sample before the focus belongs to the near field, the rest to the far
//    one.
//    Far field, ring by ring from outside: samples whose a reaches past the ring's outer
//    border join the bucket `previous`, the others `current`. Then
//      occlusion = sat(mean a of previous - mean a of current)
//      opacity of current = its sum of sat(a - d + 1/2) / taps of the ring
//      previous = previous (1 - opacity occlusion) + current
//    Near field: colour = sum w c / sum w, opacity = sat(gain sum w). The gain makes a surface
//    of any one radius opaque. The background of a near pixel is guessed from the far samples
//    within the tile's reach.
// 4. A median of 3x3 over either field.
// 5. At full resolution, with both fields interpolated bilinearly:
//      out = mix(mix(sharp, far, t(r) behind the focus, sat(-r - 2) before it), near, opacity)
//
// The cost is that of the taps, whose number stops growing at radius 10.
//
// Known failures: from radius 10 on taps lie apart, and small lights become dots; the median
// removes isolated lights; half resolution doubles the width of anything one pixel wide; the
// background behind a near thing is guessed.

#include "dof/dof.h"

namespace softfocus {

/// A Method's apply (dof.h).
void ring_bucket(const DofInput& input, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus

#pragma once
// Ring-bucket gather, after Abadie 2018: half resolution, tiles that know the circles that
// reach them, taps on rings from the outermost in, and the near field by itself.
//
// 1. Each 2x2 pixels become one: the nearest's signed radius r (of full resolution), and
//    the mean colour of those within a pixel of radius of it. Half resolution itself, with
//    the interpolation back, has the second moment of a disc of radius 2; the tap that is
//    to spread a pixel over what is missing has the size, in half-resolution pixels,
//      a = max(1/2, sqrt(r^2 - 4) / 2);   t(r) = sat((r^2 - 1/4) / (4 - 1/4))
//    and t is how much of a pixel half resolution shows.
// 2. Tiles of 16x16 hold the largest a that reaches them from any tile, rounded up to
//    quarters: K. Their taps lie
//    on n = ceil(K) rings, 1 to 5, at i s pixels, s = max(K/n, 1), 8 i on ring i, rounded to
//    pixels: 9 to 121 taps.
// 3. A sample p at distance d weighs
//      w = sat(a - d + 1/2) / max(1, a^2 D),   D = taps / ((n + 1/2) s)^2
//    It belongs to the near field by t where it lies before the focus, else to the far one.
//    Far field, ring by ring from outside: samples whose a reaches past the ring's outer
//    border join the bucket `previous`, the others `current`, and then
//      occlusion = sat(mean a of previous - mean a of current)
//      opacity of current = its sum of sat(a - d + 1/2) / taps of the ring
//      previous = previous (1 - opacity occlusion) + current
//    Near field: colour = sum w c / sum w, opacity = sat(gain sum w), with the gain that
//    makes a surface of any one radius opaque. Pixels of the near field take as their
//    background what lies behind them within the tile's reach.
// 4. A median of 3x3 of either.
// 5. At full resolution, both interpolated bilinearly:
//      out = mix(mix(sharp, far, t(r) behind the focus, sat(-r - 2) before it), near, opacity)
//
// Cost: that of the taps, which stop growing at radius 10.
//
// Known failures: at more than radius 10 taps lie apart, and small lights become dots; the
// median takes isolated lights away; half resolution takes what is one pixel wide for
// two; the background behind a near thing is guessed.

#include "dof/dof.h"

namespace softfocus {

void ring_bucket(const DofInput& input, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus

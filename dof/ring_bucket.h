#pragma once
// Ring-bucket gather, after Abadie 2018: half resolution, tiles that know the circles that
// reach them, taps on rings from the outermost in, and the near field by itself.
//
// 1. Each 2x2 pixels become one: the nearest's signed radius h, in half-resolution pixels,
//    and the mean colour of those within a pixel of radius of it.
// 2. Tiles of 16x16 hold the largest |h| that reaches them from any tile: K. Their taps lie
//    on n = ceil(K) rings, 1 to 5, at i s pixels, s = max(K/n, 1), 8 i on ring i, rounded to
//    pixels: 9 to 121 taps.
// 3. A sample p at distance d whose |h| is a weighs
//      w = sat(a - d + 1/2) / max(1, a^2 D),   D = taps / ((n + 1/2) s)^2
//    Behind the focus, ring by ring from outside: samples whose a reaches past the ring's
//    inner border join the bucket `previous`, the others `current`, and then
//      occlusion = sat(mean a of previous - mean a of current)
//      opacity of current = its sum of sat(a - d + 1/2) / taps of the ring
//      previous = previous (1 - opacity occlusion) + current
//    Before the focus: near colour = sum w c / sum w, near opacity = sat(gain sum w), with
//    the gain that makes a surface of any one radius opaque.
//    Pixels before the focus take as their background what lies behind them within reach.
// 4. A median of 3x3 of either.
// 5. At full resolution, both interpolated bilinearly:
//      out = mix(mix(sharp, background, sat(|r| - 1/2)), near, near opacity)
//
// Cost: that of the taps, which stop growing at radius 10.
//
// Known failures: at more than radius 10 taps lie apart, and small lights become dots; the
// median takes isolated lights away; half resolution softens what is slightly blurred, and
// edges of two pixels; the background behind a near thing is guessed.

#include "dof/method.h"

namespace softfocus {

void ring_bucket(const DofInput& input, Image& result, ThreadPool& pool);

}  // namespace softfocus

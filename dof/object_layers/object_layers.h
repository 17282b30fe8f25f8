#pragma once
// Object identification, after Barsky, Tobias, Chu and Horn 2005 ("Elimination of artifacts due
// to occlusion and discretization problems in image space blurring techniques") and Barsky 2004
// ("Vision-realistic rendering"): layers of equal blur, each convolved by itself, in which no
// object is cut at a layer's border and every object goes on behind what hides it.
//
//   1. Objects: numbers that come with the picture, or sets of adjacent pixels without a step in
//      depth (picture_objects.h).
//   2. Behind the borders of nearer objects the farther ones are continued, in colour and in depth
//      (hidden_parts.h). A pixel P then has a visible surface of radius v and colour c, and
//      perhaps a hidden one, h and e, that is there with the share f.
//   3. Layers k, nearest first. B_k(r) is how much of a surface lies at layer k or behind it,
//      from 0 to 1; layers overlap, and a surface between two of them counts to both. Of P,
//        v_k = B_k(v) - B_(k+1)(v)          h_k = f (B_k(h) - B_(k+1)(h)) (1 - v_k)
//        own_k  = v_k + h_k                 light_k = v_k c + h_k e
//        join_k = B_(k-1)(the largest radius that the object of P has anywhere)
//        seen_k = max(own_k, B_k(v) + max(0, f B_k(h) - B_k(v)) (1 - join_k))
//   4. D_k is the sum over the layer's disc. At each place, from T = 1 on, nearest layer first:
//        out += T D_k(light_k) / D_k(seen_k);   T *= 1 - D_k(own_k) / D_k(seen_k)
//      and in the end out / (1 - T).
//
// join_k is what the objects are for. A layer hides by own / seen. Where P's object has nothing at
// layer k, seen_k counts all that is known there, hidden surfaces too: the layer lies behind an
// independent thing, as "over" supposes. Where the object reaches layer k, P's nearer part is left
// out of seen_k: the object's shares in its layers add up to one whole. So it is as opaque as if
// it lay in one layer, and has no seam where layers meet. The paper gets there by giving each of
// the layers that an object straddles the entire object. That takes the object for one of a single
// blur, and a floor from here to the horizon is none.
//
// Colours are those of disc_slopes.h. Layers are the rungs of disc_ladder.h, levels included: a
// layer from a radius of 8 pixels on is blurred in pixels 2, 4, ... across. The paper's are uniform
// in dioptres, that is in radius, with steps that an eye does not tell apart; these become coarser
// with the radius, for a disc of 60 pixels looks like one of 63.
//
// Known failures:
// - What is hidden is drawn out from the borders of what is visible: texture becomes streaks along
//   rows and columns, and a lamp at a border becomes a line of light.
// - One hidden surface a pixel: of two things behind each other, the farther one is not continued.
// - Where a surface passes from layer to layer, up to 1/500 of what lies behind it shows through.
// - An object that is hidden but for a few pixels goes on as those pixels.
// - A number is known for pixels alone: an object half as wide as a pixel is one where it is drawn.
// - Two things in one layer count as one surface there.
// - A circle between two rungs is two discs, and large discs are coarse (disc_layers.h).

#include "dof/dof.h"

namespace softfocus {

void object_layers(const DofInput& input, const ImageView& result, ThreadPool& pool);

/// Pixel by pixel, as in the equations; slow. For tests.
void object_layers_oracle(const DofInput& input, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus

#pragma once
// Layers, after Scofield 1992 and Real-Time Rendering (4th edition, 12.4): split by depth, blur
// each layer by itself as premultiplied colour and opacity, composite near over middle over far.
//
// The sources blur a layer by one radius, which would blur a floor the same all along; here
// every pixel has its own disc, of scatter_discs.h, and sums are exact as scatter's are.
//
// Where depth is cut depends on the picture (split_layers() in layer_planes.h). A picture does
// not show what a layer hides, and a lens sees past edges, so the layers behind are filled in
// first (layer_planes.h):
//
//   far      is whole: behind the others its colour and radius are guessed from the far pixels
//            around
//   middle   behind near: the share a of middle pixels among those around that are not near,
//            with their colour
//   near     a = 1 where it is, else 0
//
// With w the weight of a pixel's disc at a place, by the layer's radius there, known or guessed,
//
//   opacity A of a layer = sum w a / (sum w a + sum w (1 - a))
//   colour C = sum w a c / sum w a
//   out = mix(mix(C_far, C_middle, A_middle), C_near, A_near)
//
// The second sum of A is that of the layer's gaps. With it the weights of an even surface need
// not add to one: neither a slope nor the picture's border lets anything through.
//
// Known failures: within a layer nothing hides anything, so a far thing shines over the edge
// of a less far one. What is hidden is a smooth guess: no texture shows through a thin near
// thing. Where a cut goes through a surface, its nearer part is blurred over a guess of its
// farther one.

#include "dof/dof.h"

namespace softfocus {

/// A Method's apply (dof.h).
void layers(const DofInput& input, const ImageView& result, ThreadPool& pool);

/// The oracle of layers(), and its scalar form: stamps each disc pixel by pixel. Equal to the
/// bit.
void layers_oracle(const DofInput& input, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus

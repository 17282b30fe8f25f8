#pragma once
// Circular blur by separable convolution with complex kernels, after Garcia 2017. A sum of
// few Gaussians with complex widths makes a disc, and each is a product of one along x and
// one along y:
//
//   k(x) = e^(-a x^2) (cos b x^2 + i sin b x^2);   disc(x, y) ~ sum over components of
//   A Re(k(x) k(y)) + B Im(k(x) k(y)) = Re((A - i B) k(x) k(y))
//
//   1 component:  a .862325, b 1.624835, A .767583, B 1.862321
//   2 components: a .886528, b 5.268909, A .411259, B -.548794
//                 a 1.960518, b 1.558213, A .513282, B 4.56111
//
// The kernel is cut at 1.2, and the disc that it then is nearest to has a radius of 1.085
// (one component) or 1.11 (two): x = 1.085 d / r and so on, or every circle of confusion
// would come out wrong. The cut is a pixel soft.
//
// A pixel gathers with its own radius r over whole pixels, first along x, then along y:
//   H = sum over x of k c / S,  S = sum of k;   V = sum over y of k H
//   out = Re sum (A - i B) S V / Re sum (A - i B) S^2
// so that a constant stays what it is. Lest sharp things bleed into what is blurred around
// them, a neighbour p counts only as far as it is blurred itself: its value is taken as
// mix(own, p's, min(1, 2 |r_p| / r)).
//
// k at d = 1, 2, ... comes of products: k(d+1) = k(d) s(d), s(d+1) = s(d) k(1)^2. k(1) is
// tabulated for sixteenths of a pixel of radius. Circles up to half a pixel stay.
//
// Cost grows with the radius, not with its square.
//
// Known failures: light that is a gather's, not spread: blurred things before the focus
// end at their outlines; one component is lumpy, with a dark rim; where the kernel is
// negative, very bright neighbours leave dark rings, cut at 0.

#include "dof/dof.h"

namespace softfocus {

void circular_one(const DofInput& input, const ImageView& result, ThreadPool& pool);
void circular_two(const DofInput& input, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus

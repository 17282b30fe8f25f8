#pragma once
// Circular blur by separable convolution with complex kernels, after Garcia 2017: a sum of
// few complex Gaussians makes a disc, and each of them is a product of one along x and one
// along y.
//
//   k(x) = e^(-a x^2) (cos b x^2 + i sin b x^2)
//   disc(x, y) ~ sum over components of A Re(k(x) k(y)) + B Im(k(x) k(y))
//              = sum over components of Re((A - i B) k(x) k(y))
//
//   1 component:  a .862325, b 1.624835, A .767583, B 1.862321
//   2 components: a .886528, b 5.268909, A .411259, B -.548794
//                 a 1.960518, b 1.558213, A .513282, B 4.56111
//
// The kernel is cut at 1.2, over a width of one pixel. The disc nearest to the cut kernel has
// a radius of 1.085 (one component) or 1.11 (two), so a circle of radius r takes k at
// x = 1.085 d / r; with d / r every circle would come out too large.
//
// Near and far field are blurred apart, at half resolution: dof/half_resolution has the fields,
// the highlights, which are drawn as even discs, and the way back. Sizes are in its cells.
// A cell gathers over its own size r, first along x, then along y:
//   H = sum over x of k c / S,  S = sum of k;   V = sum over y of k H
//   out = Re sum (A - i B) S V / Re sum (A - i B) S^2
// A constant stays constant.
//   Far field: a neighbour p counts only as far as it is blurred itself, so that sharp things
//   do not bleed: its value is mix(own, p's, min(1, 2 w_p r_p / r)), w its weight.
//   Near field: premultiplied colour and opacity. Its size goes on outside of it, filled from
//   around (fill_holes.h): there cells gather what spreads over them. Dilation by the
//   largest size around would give small circles the size of their neighbours.
//   Tiles that nothing near reaches are left out.
//
// k at d = 1, 2, ... comes of products: k(d+1) = k(d) s(d), s(d+1) = s(d) k(1)^2. A table
// has k(1) for sizes in sixteenths of a cell. Sizes up to half a cell count as none.
//
// The cost grows with the radius, not with its square.
//
// Known failures: the background behind a near thing is a guess from around it; one component
// is lumpy, with a dark rim; the kernel is negative in places, so large bright things have dark
// rings around them, cut at 0; where a far thing ends before a farther one, its own size decides
// on either side.

#include "dof/dof.h"

namespace softfocus {

/// Two Methods' apply (dof.h): of one component and of two.
void circular_one(const DofInput& input, const ImageView& result, ThreadPool& pool);
void circular_two(const DofInput& input, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus

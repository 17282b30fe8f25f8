#pragma once
// Scatter: every pixel spreads its light evenly over the disc of its circle of confusion, and
// each place divides the light that arrived by the weights that arrived.
//
//   w_P(Q) = coverage of pixel Q by P's disc / sum of that disc's coverages
//   scatter         out(Q) = sum_P w_P(Q) c_P / sum_P w_P(Q)
//                   after Potmesil and Chakravarty 1981/82
//   scatter-sorted  the same sums in each slab of depth k. They give a colour C_k and an
//                   opacity a_k = min(1, sum w_P(Q)), and the slabs lie over each other from
//                   the nearest to the farthest:
//                   a'_k = min(1, a_k / (1 - a'_(k-1)));  out = sum T_k a'_k C_k / sum T_k a'_k
//                   T_k is the product of 1 - a' of all nearer slabs
//
// The slabs of scatter-sorted end at |r| = 1/2, 3/2, 3, 6, 12, ... pixels on either side of
// the focus. A surface that runs through depth lies in neighbouring slabs: their opacities are
// shares of one whole, which add (hence a'). Only slabs that do not touch are independent, as
// "over" supposes.
//
// Discs come in quarters of a pixel of radius. In a row of pixels a disc is a span as wide as
// its area there, in eighths of a pixel to either side: coverage falls off softly at the
// ends, and the second moment is the disc's. Circles up to a radius of 5/8 stay in their
// pixel.
//
// The lanes form adds each span to a row of differences, in four places; one running sum over
// the row turns differences into light. That takes 8 r + 4 additions a pixel, not pi r^2. The
// sums are exact, of whole units of 2^-34: a bright disc leaves nothing behind, and neither
// order nor threads make a difference. Light that leaves the picture is lost; the division
// makes up for it.
//
// Known failures. scatter: blurred things shine over sharp ones before them and the reverse,
// by their weights alone. scatter-sorted: light hidden by a foreground is missing behind its
// blurred edge, where the nearest visible neighbours fill in; two surfaces in neighbouring
// slabs count as one.

#include "dof/dof.h"

namespace softfocus {

/// Two Methods' apply (dof.h).
void scatter_unsorted(const DofInput& input, const ImageView& result, ThreadPool& pool);
void scatter_sorted(const DofInput& input, const ImageView& result, ThreadPool& pool);

/// How depth is cut: not at all, or into slabs.
enum class SlabRule { one, doubling };
void scatter_in_slabs(const DofInput& input, const ImageView& result, SlabRule rule,
                      ThreadPool& pool);

/// The oracle of scatter_in_slabs(), and its scalar form: stamps each disc pixel by pixel.
/// Equal to the bit.
void scatter_in_slabs_oracle(const DofInput& input, const ImageView& result, SlabRule rule,
                             ThreadPool& pool);

}  // namespace softfocus

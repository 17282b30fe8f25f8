#pragma once
// Scatter, after Potmesil and Chakravarty 1981/82: every pixel spreads its light evenly
// over the disc of its circle of confusion, energy over area, and each place divides what
// arrived by the weights that arrived:
//
//   w_P(Q) = coverage of pixel Q by P's disc / sum of that disc's coverages
//   scatter         out(Q) = sum_P w_P(Q) c_P / sum_P w_P(Q)
//   scatter-sorted  the same sums in slabs of depth k, which give a colour C_k and an
//                   opacity a_k = min(1, sum w_P(Q)); from the nearest slab to the
//                   farthest with "over":
//                   a'_k = min(1, a_k / (1 - a'_(k-1)));  out = sum T_k a'_k C_k / sum T_k a'_k
//                   with T_k the product of 1 - a' of what is nearer
//
// The slabs end at |r| = 1/2, 3/2, 3, 6, 12, ... pixels on either side of the focus: a
// surface that runs through depth lies in neighbouring ones, so theirs are shares of one
// whole, which add (hence a'), and only slabs that do not touch are independent of each
// other, as "over" supposes.
//
// Discs come in quarters of a pixel of radius. A row of a disc is a span as wide as the
// disc's area in that row of pixels, in eighths of a pixel to either side, so coverage
// falls off softly at its ends and the second moment is the disc's. Circles up to a radius
// of 5/8 stay in their pixel.
//
// The fast form adds a span to a row of differences in four places, and one running sum a
// row turns them into light: 8 r + 4 additions a pixel, not pi r^2. Sums are of whole
// numbers, units of 2^-34, so that they are exact: nothing is left behind a bright disc,
// and order and threads make no difference. What leaves the picture is lost, and the
// division makes up for it.
//
// Known failures: unsorted, blurred things shine over sharp ones before them and the
// reverse, by the weights alone; sorted, what a foreground hides is missing (there is no
// light of it to be seen through the blurred edge: the nearest visible neighbours fill in),
// and two surfaces in neighbouring slabs count as one.

#include "dof/dof.h"

namespace softfocus {

void scatter_unsorted(const DofInput& input, const ImageView& result, ThreadPool& pool);
void scatter_sorted(const DofInput& input, const ImageView& result, ThreadPool& pool);

/// How depth is cut: not at all, into near, focus and far (layers.h), or into the slabs
/// above.
enum class SlabRule { one, layers, doubling };
void scatter_in_slabs(const DofInput& input, const ImageView& result, SlabRule rule, ThreadPool& pool);

/// Its oracle, which stamps each disc pixel by pixel; equal to the bit.
void scatter_in_slabs_plain(const DofInput& input, const ImageView& result, SlabRule rule, ThreadPool& pool);

}  // namespace softfocus

#pragma once
// One-pass in the order of how much is to be gained, after Fearing 1995: the picture is there
// at once, roughly, and is made exact where that shows most, until the work that may be spent is
// spent. With all work spent it is one-pass's picture, to the bit.
//
// Rough, with D the picture at half size (means of 2x2 pixels) and L what one-pass makes of it,
// both magnified bilinearly; r is a pixel's radius, C its colour:
//   E = L + (1 - s) (C - D),   s = clamp((|r| - 1/2) / (3/2), 0, 1)
// A blurred pixel is the small picture's; a sharp one keeps its detail, and takes the change
// that the blur of its neighbours makes. One-pass at half size is a 16th of the work.
//
// The importance of a block of 16x8 pixels is how much it should change if it were exact, for
// the work that this takes:
//   sum over the block of |E - E'| / (1 + max(E, E')),  divided by reach^2
// E is here the picture at half size, L, and E' what the quarter size (a 256th of the work)
// would have made of it: where the two agree, the exact picture should agree with them. To that
// comes |E - C| / (4 r^2) for |r| > 1, in the same quotient, because circles below 2 pixels do not
// show at half size. The quotient keeps bright lights from counting for more than they show.
// Blocks that nothing blurs are exact as they are and cost nothing.
//
// Fearing orders single pixels by the change of colour, depth and circle since the last frame,
// and leaves out what does not change. Here a still picture is ordered too.
//
// Known failures: those of one-pass; and outside the blocks made exact, edges of blurred things
// are soft by two pixels, and may step at the blocks' borders.

#include "dof/dof.h"

namespace softfocus {

/// The order in which blocks become exact. All but the first are there to compare with.
enum class BlockOrder { importance, rows, random };

/// Spends at most the share `budget`, 0 to 1, of the work that one-pass takes on this picture;
/// the rough pictures' own work is not counted.
void refine(const DofInput& input, float budget, BlockOrder order, const ImageView& result,
            ThreadPool& pool);

/// refine() by importance with DofSettings::budget.
void importance_ordered(const DofInput& input, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus

#pragma once
// The two-pass filter (Zhou, Chen and Pullen 2007; the thesis, eq. 10 to 14): weights.h
// along x, and then along y on the first pass's result. Depth stays in alpha, the
// image between the passes is RGBA16F, stored with the profile's rounding.
//
// One pass, at pixel C, in binary32, with every tap outside the picture moved to its
// edge:
//   gather = C;  for d = 1 .. ceil(max_coc) - 1: add C - d, add C + d;  resolve
//
// Known failures: the weights of the second pass know nothing of the first (the filter
// is not separable), so strong blur is boxy; circles larger than max_coc are cut; what
// a foreground hides is not there to be blurred (no partial occlusion).

#include "dof/dof.h"

namespace softfocus {

/// The filter, line by line: every quantity of a pixel is computed once a pass. Cost
/// grows with the largest radius that is in the picture, up to max_coc.
void two_pass(const DofInput& input, const ImageView& result, ThreadPool& pool);

/// The same with RGBA32F between the passes: what storage as halves costs.
void two_pass_single(const DofInput& input, const ImageView& result, ThreadPool& pool);

/// The same filter as a fragment shader would be written, every tap from the texture:
/// the oracle of two_pass, equal to the bit.
void two_pass_plain(const DofInput& input, const ImageView& result, ThreadPool& pool);

/// That of two_pass_single.
void two_pass_single_plain(const DofInput& input, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus

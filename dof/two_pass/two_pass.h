#pragma once
// The two-pass filter (Zhou, Chen and Pullen 2007; the thesis, equations 10 to 14): weights.h
// along x, and then along y on the first pass's result. Depth stays in alpha. The picture
// between the passes is RGBA16F, stored with the profile's rounding.
//
// One pass, at pixel C, in binary32; taps outside the picture move to its edge:
//   gather = C;  for d = 1 .. ceil(max_coc) - 1: add C - d, add C + d;  resolve
//
// Known failures: the second pass's weights know nothing of the first pass (the filter is not
// separable), so strong blur is boxy; circles larger than max_coc are cut; a foreground hides
// what its blur should let through (no partial occlusion).

#include "dof/dof.h"

namespace softfocus {

/// The filter. Its cost grows with the largest radius in the picture, up to max_coc.
void two_pass(const DofInput& input, const ImageView& result, ThreadPool& pool);

/// With RGBA32F between the passes: shows what storage as halves costs.
void two_pass_single(const DofInput& input, const ImageView& result, ThreadPool& pool);

/// The oracles of both, equal to the bit: every tap is fetched from the picture, up to max_coc.
void two_pass_oracle(const DofInput& input, const ImageView& result, ThreadPool& pool);
void two_pass_single_oracle(const DofInput& input, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus

#pragma once
// The one-pass filter with circular sampling (the thesis, 5.1): the weights of
// weights.h over rings around the centre, in a single pass. It is round where the
// two-pass filter is boxy, and its cost grows with the square of the radius.
//
// Ring k holds the texels whose distance from the centre, sqrt(dx^2 + dy^2), rounds to
// k, so each texel of the disc is sampled exactly once and a bright point's image has
// no holes (samples at even angles, rounded to texels, leave some out and take others
// twice). A sample's d is its own distance, not its ring's.
//
// At pixel C, in binary32, with every tap outside the picture moved to its edge:
//   gather = C;  ring by ring, in a ring by dy, then dx: add C + (dx, dy);  resolve
//
// Known failures: circles larger than max_coc are cut; no partial occlusion.

#include <vector>

#include "dof/dof.h"

namespace softfocus {

/// One sample of a ring.
struct RingTap {
  int dx;
  int dy;
  float distance_px;
};

/// The samples nearer than `radius_px`, in the order in which they are added.
std::vector<RingTap> ring_taps(float radius_px);

void one_pass(const DofInput& input, const ImageView& result, ThreadPool& pool);

/// The oracle of one_pass: as a fragment shader would be written.
void one_pass_plain(const DofInput& input, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus

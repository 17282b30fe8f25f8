#pragma once
// The one-pass filter with circular sampling (the thesis, 5.1): the weights of weights.h over
// rings around the centre, in a single pass. It is round; the two-pass filter is boxy. Its
// cost grows with the square of the radius.
//
// Ring k holds the texels whose distance from the centre, sqrt(dx^2 + dy^2), rounds to k. So
// each texel of the disc is sampled exactly once, and a bright point's image has no holes
// (samples at even angles, rounded to texels, miss some texels and hit others twice). A
// sample's d is its own distance, not its ring's.
//
// At pixel C, in binary32; taps outside the picture move to its edge:
//   gather = C;  ring by ring, in a ring by dy, then dx: add C + (dx, dy);  resolve
//
// Known failures: circles larger than max_coc are cut; a foreground hides what its blur should
// let through (no partial occlusion).

#include <span>
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

/// The filter. Its cost grows with the square of the largest radius in the picture.
void one_pass(const DofInput& input, const ImageView& result, ThreadPool& pool);

/// Blocks of pixels that can be filtered by themselves. A vector of the widest unit is a row.
inline constexpr int kBlockWidth = 16;
inline constexpr int kBlockHeight = 8;

struct OnePassBlock {
  int column, row;  ///< of blocks
  int reach;        ///< 1 or more: how far its taps must go, tap_count() of what reaches it
};

/// one_pass() of some blocks, each listed once; other pixels stay. The work grows with the
/// square of a block's reach.
void one_pass_blocks(const DofInput& input, std::span<const OnePassBlock> blocks,
                     const ImageView& result, ThreadPool& pool);

/// The oracle, equal to the bit: every tap is fetched from the picture, up to max_coc.
void one_pass_oracle(const DofInput& input, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus

#pragma once
// The ladder of radii that mipmap.h blurs with.
//
// Rung radii are 0, 1, sqrt(2), 2, ..., half an octave apart. Level 0, the picture itself, has
// the first kFineMipRungs, every further level kMipLevelRungs. With fewer rungs on level 0 the
// filters are smaller, but the discs too soft: mean FLIP over 16 random scenes is .0112 with 7,
// .0121 with 6, .0138 with 5.

#include <vector>

namespace softfocus {

inline constexpr int kFineMipRungs = 7;
inline constexpr int kMipLevelRungs = 2;
/// Pixels of a level that a circular filter reaches at most.
inline constexpr int kMipReach = 6;

/// sat((square - begin) * slope) of a pixel belongs to a rung and to larger ones.
struct MipStep {
  float begin, slope;
};

/// A circular filter: weights[dy][dx] for a quadrant, which sum to 1 over all four.
struct MipRung {
  float square;  ///< of the radius, in pixels of the picture
  MipStep step;
  int reach;
  float weights[kMipReach + 1][kMipReach + 1];
};

struct MipLevelRungs {
  std::vector<MipRung> rungs;
  MipStep beyond;  ///< what belongs to the levels above
};

/// All levels up to the one with a rung of at least `largest_px`.
std::vector<MipLevelRungs> make_mip_ladder(float largest_px);

}  // namespace softfocus

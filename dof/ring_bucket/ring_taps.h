#pragma once
// The taps of ring_bucket.h, from the outermost ring in.

#include <vector>

namespace softfocus {

/// A square of `spacing` cells about (dx, dy), seen through the level of that spacing.
struct BucketTap {
  int dx, dy;
  float distance;  ///< in spacings
  float area;      ///< cells
};
struct BucketRing {
  int first, end;  ///< of the taps
  int level;       ///< spacing 2^level
  float inverse_spacing;
  float border;        ///< its outer radius, in cells
  float inverse_area;  ///< 1 / sum of its taps' areas
};

struct RingTaps {
  std::vector<BucketTap> taps;
  std::vector<BucketRing> rings;  ///< the outermost first
  /// 1 / A(a) for a = 0, 1/16, 2/16, ... cells: A = sum of areas times overlaps.
  std::vector<float> light;
  int levels;
  std::vector<float> least_size;  ///< of a level: smaller cells reach none of its taps
  int reach;                      ///< the largest |dx| and |dy|
};

/// Taps for sizes up to `largest`.
RingTaps make_ring_taps(float largest);

/// The number of rings to leave out, from the outermost on, if no size is above `size`.
int rings_outside(const RingTaps& taps, float size);

}  // namespace softfocus

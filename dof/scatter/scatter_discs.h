#pragma once
// The discs that scatter.h spreads light over, as spans.

#include <cstdint>
#include <vector>

namespace softfocus {

/// One row of a disc about x: pixels x - whole to x + whole are covered fully, and the
/// next on either side by `eighths`. With whole = -1 these two are the same pixel, x, which
/// then is covered by 2 eighths - 8 eighths. whole = -2: the row is not reached.
struct DiscSpan {
  std::int16_t whole;
  std::int16_t eighths;  ///< 0 to 7
};

struct ScatterDiscs {
  int count;                    ///< of radii 0, 1/4, 1/2, ... pixels
  int reach;                    ///< rows above and below the centre, of the largest
  std::vector<DiscSpan> spans;  ///< row by row: of all discs the one at |dy|
  std::vector<int> reaches;     ///< rows above and below, of each
  std::vector<float> weights;   ///< 1 / sum of the coverages, of each
};

/// Discs up to a radius.
ScatterDiscs make_discs(float largest_px);

/// The disc for a radius, which may be negative.
inline int disc_of(float radius_px) {
  return static_cast<int>((radius_px < 0.0f ? -radius_px : radius_px) * 4.0f + 0.5f);
}

}  // namespace softfocus

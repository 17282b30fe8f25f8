#pragma once
// A line of pixels in the form in which vector kernels filter it. A node is one place
// of the line in as many lines as a vector has lanes: 16 rows are filtered along x at
// once, one a lane, then 16 columns along y. Neighbours along the line are then whole
// vectors, which no tap cuts across.
//
// Two forms of each node are kept side by side. Where P's circles cover the receivers
// (overlap 1) and nothing leaks (leakage 1), its weight W(P) = (1 * I) * 1 is its
// intensity to the bit, and colour * W(P) is one product for all receivers: such a tap
// is four additions. `covers` says how far that holds.

#include <cstdint>

namespace softfocus {

/// Arrays by node; the first two hold four vectors a node. Around the nodes that are
/// filtered lie as many as the taps reach.
struct GatherNodes {
  float* whole;  ///< intensity; intensity * red, green, blue
  float* part;   ///< radius, its sign set beyond the focus; red, green, blue

  /// The largest distance at which all of a node's pixels have overlap 1.
  std::int32_t* covers;
  /// The same, but 0 where a pixel lies beyond the focus, for receivers that leakage
  /// concerns.
  std::int32_t* covers_all;
  /// The largest distance at which any of its pixels has an overlap.
  std::int32_t* touches;
};

}  // namespace softfocus

#pragma once
// The layers of object-identification in the order of depth, and where each begins.

#include <cstdint>
#include <vector>

#include "dof/disc_layers/disc_ladder.h"

namespace softfocus {

/// How much of a surface lies at a layer or behind it: slope * s + offset, from 0 to 1, of its
/// signed square s, r^2 behind the focus and -r^2 before it.
struct LayerBegin {
  float slope, offset;
};

inline float share_behind(LayerBegin begin, float square) {
  return std::max(std::min(square * begin.slope + begin.offset, 1.0f), 0.0f);
}

/// A layer: a rung of disc_ladder.h on one side of the focus.
struct ObjectRung {
  /// Begins of the layer before, of this one and of the next.
  LayerBegin before, begin, next;
  const Rung* rung;  ///< in ObjectLadder::levels
};

struct ObjectLadder {
  std::vector<LevelRungs> levels;
  /// Of a level: layers before the focus and behind it, the nearest first. The one in focus is
  /// the first behind it in level 0.
  std::vector<std::vector<ObjectRung>> near, far;
};

/// Layers up to a radius, 0 to kLargestMaxCoc.
ObjectLadder make_object_ladder(float largest_px);

/// The rungs that a square from 0 on counts to, one or two: bits, numbered over all levels.
std::uint64_t rungs_of(float square);

/// The number of a level's first rung.
inline int first_rung(std::size_t level) {
  return level == 0 ? 0 : kFineRungs + kLevelRungs * (static_cast<int>(level) - 1);
}

}  // namespace softfocus

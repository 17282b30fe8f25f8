#pragma once
// The radii that disc-layers (disc_layers.h) blurs with, and their discs.
//
// A rung is a radius. Rung 0 is in focus; the squares of the others are 1, 3/2, 2, 3, 4, 6,
// 8, 12, ... square pixels. A pixel between two rungs counts to both, in shares by which the
// mean of their squares is its own square: the blur then has the second moment of its circle.
// Rungs below a radius of 8 pixels work on the picture itself, level 0. Each doubling of the
// radius beyond works on pixels of twice the size.

#include <vector>

#include "dof/level_stack.h"

namespace softfocus {

inline constexpr int kFineRungs = 13;  ///< of level 0, including the one in focus
inline constexpr int kLevelRungs = 4;  ///< of each other level

/// A column of a disc about y: pixels y - whole to y + whole weigh `centre`, the next on
/// either side `end`.
struct LadderSpan {
  int whole;
  float centre, end;
};

struct Rung {
  float square;  ///< of the radius in pixels of the picture
  RungStep step;
  std::vector<LadderSpan> spans;  ///< the disc's coverages at |dx| = 0, 1, ...
  float area;                     ///< their sum
};

/// The rungs of a level, the smallest first, and the step to the next level. Everything from
/// square 0 on belongs to the first rung or to larger ones.
struct LevelRungs {
  std::vector<Rung> rungs;
  RungStep beyond;
};

/// Levels up to a radius, 0 to kLargestMaxCoc. Nothing belongs beyond the last.
std::vector<LevelRungs> make_ladder(float largest_px);

}  // namespace softfocus

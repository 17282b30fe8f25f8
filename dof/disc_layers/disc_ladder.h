#pragma once
// The radii that disc-layers (disc_layers.h) blurs with, and their discs.
//
// A rung is a radius. Rung 0 is in focus; the squares of the others are 1, 3/2, 2, 3, 4, 6,
// 8, 12, ... square pixels. A pixel between two rungs counts to both, so that the mean of
// their squares is its own: the blur then has the second moment of its circle. Rungs of a
// radius below 8 pixels work on the picture itself, level 0; each further doubling of the
// radius works on pixels of twice the size.

#include <algorithm>
#include <vector>

namespace softfocus {

inline constexpr int kFineRungs = 13;  ///< of level 0, with the one in focus
inline constexpr int kLevelRungs = 4;  ///< of each other level

/// Where a rung begins, in squares of radii.
struct RungStep {
  float begin, slope;
};

/// How much of a pixel belongs to a rung or to larger ones.
inline float share_from(RungStep step, float square) {
  return std::max(std::min((square - step.begin) * step.slope, 1.0f), 0.0f);
}

/// A column of a disc about y: `centre` times the pixels y - whole to y + whole, and `end`
/// times the next on either side.
struct LadderSpan {
  int whole;
  float centre, end;
};

struct Rung {
  float square;  ///< of the radius in pixels of the picture
  RungStep step;
  std::vector<LadderSpan> spans;  ///< at |dx| = 0, 1, ...; of coverages, not divided by the area
  float area;                     ///< the disc's sum where there is 1 everywhere
};

/// The rungs of a level, the smallest first, and the step to the next level's. The first
/// rung's step is 1 for every square from 0 on.
struct LevelRungs {
  std::vector<Rung> rungs;
  RungStep beyond;
};

/// Levels up to a radius; none lies beyond.
std::vector<LevelRungs> make_ladder(float largest_px);

}  // namespace softfocus

#pragma once
// What lies behind: the unknown pixels of a sheet guessed from the known ones around them, by
// pull-push (Gortler et al. 1996).
//
//   pull   a level of half the size: known if any of its 2x2 pixels is, with their mean
//   push   from the coarsest level on: an unknown pixel is the coarser level, bilinearly
//          (weights 9, 3, 3, 1 of 16)
//
// Of an odd number of rows or columns the middle one counts as two, so that a mirrored sheet
// gives the mirrored guess.
//
// A hole becomes a smooth blend of its surroundings. The cost is the same for holes of any
// size.

#include "dof/picture_planes.h"

namespace softfocus {

/// Guesses unknown pixels. Planes 0 to values - 1 are values, finite where they are known, the
/// next plane tells: 1 known, 0 not. Known pixels stay as they are, and so does a sheet with
/// no known pixel.
void guess_hidden(Planes& sheet, int values, ThreadPool& pool);

/// Along one axis: the two pixels that make a pixel of the level of half the size.
struct PullPair {
  int first, second;
};
PullPair pull_pair(int coarse, int fine_size);

/// Along one axis: the two pixels of the coarser level that a pixel lies between, and the nearer
/// one's share.
struct PushTap {
  int near, far;
  float near_share;
};
PushTap push_tap(int fine, int fine_size);

}  // namespace softfocus

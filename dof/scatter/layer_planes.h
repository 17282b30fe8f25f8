#pragma once
// A picture cut by depth into three layers, each filled in behind nearer ones: what layers.h
// blurs, before it is blurred.

#include "dof/picture_planes.h"

namespace softfocus {

/// Signed radii: near is below near_px, far above far_px, the middle layer between.
struct LayerSplit {
  float near_px;  ///< -1/2 or less
  float far_px;   ///< 1/2 or more
};

/// Cuts where things fall apart and no surface is cut through: on either side of the focus at
/// the radius R, in quarters of a pixel, with the largest
///
///   sum of |step in radius| of neighbours that the cut parts and whose step is above 1/2 pixel
///   - R times the number of other neighbours that it parts
///
/// R is how far a cut through a surface shows. A side where no cut has more than 0 is not cut.
/// `scene` is split_picture()'s, here and below.
LayerSplit split_layers(const Planes& scene);

/// Planes of a layer: red, green and blue times opacity, opacity, signed radius. The radius is
/// guessed where the layer has none.
inline constexpr int kLayerOpacity = 3;
inline constexpr int kLayerRadius = 4;
inline constexpr int kLayerPlanes = 5;

/// Opaque where the picture shows it.
Planes near_layer(const Planes& scene, const LayerSplit& split, ThreadPool& pool);

/// Opaque where the picture shows it. Behind the near layer its colour and opacity are guessed
/// from all that is around and not near.
Planes mid_layer(const Planes& scene, const LayerSplit& split, ThreadPool& pool);

/// Opaque everywhere: guessed where the picture does not show it. Without a far pixel it is the
/// picture.
Planes far_layer(const Planes& scene, const LayerSplit& split, ThreadPool& pool);

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

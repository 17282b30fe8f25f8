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
/// guessed where the layer has none (hidden_sheet.h).
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

}  // namespace softfocus

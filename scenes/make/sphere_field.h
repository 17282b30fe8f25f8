#pragma once
// A scene of as many triangles as one asks for: 250 equal spheres in front of the camera,
// from half the focus distance to far beyond it, that cover most of the picture.

#include "scenes/scene.h"

namespace softfocus {

inline constexpr int kFieldSpheres = 250;
inline constexpr int kLeastFieldTriangles = 1500;  ///< 6 a sphere, the coarsest there is
inline constexpr int kMostFieldTriangles = 8'000'000;

/// How a sphere is cut (make_sphere()).
struct SphereCut {
  int segments;
  int rings;
};

/// The cut whose 250 spheres have the number of triangles nearest to `triangles`, with cells
/// between square and four times as high as wide at the equator.
/// Needs kLeastFieldTriangles <= triangles <= kMostFieldTriangles.
SphereCut sphere_cut(int triangles);

/// The field for a picture `aspect` times as wide as high. 64000, 256000 and 1024000
/// triangles are met exactly.
Scene sphere_field(int triangles, double aspect);

}  // namespace softfocus

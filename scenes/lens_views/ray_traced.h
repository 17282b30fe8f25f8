#pragma once
// Distributed rays through a thin lens (Cook, Porter and Carpenter 1984), against the
// triangles that the rasterizer draws, lit and textured by the same functions. Embree
// traces; a build without it lacks this method.

#include <string_view>

#include "scenes/lens_views/lens_view_method.h"

namespace softfocus {

/// Empty, or what is missing.
std::string_view ray_traced_missing();

/// A pixel's ray leaves the lens at a point of lens_points() and goes through the point of
/// the plane in focus that the pixel sees. Each pixel takes the points in blocks of its own, so
/// that few samples leave noise, not ghosts.
///
/// The same bits for any number of threads, but not on every machine: Embree's
/// intersections differ in their last bits from one vector unit to the next.
SampledPicture ray_traced(const LensViewInput& input, ThreadPool& pool);

}  // namespace softfocus

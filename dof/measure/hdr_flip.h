#pragma once
// HDR-FLIP: the largest FLIP of each pixel over all exposures at which something of the
// reference shows.
//
// Source: Andersson, Nilsson, Shirley, Akenine-Moller, "Visualizing Errors in Rendered
// High Dynamic Range Images" (2021). The first exposure takes the reference's largest
// luminance to 0.85 on the film's curve (filmic_tone), the last its median; between them
// as many as there are stops, at least two, at equal distances.

#include "dof/measure/flip.h"

namespace softfocus {

/// In stops: values are multiplied by 2^stops.
struct ExposureRange {
  double first_stops = 0.0;
  double last_stops = 0.0;
  int count = 1;
};

/// For a black picture one exposure of 0 stops. A median below 2^-14, the least normal
/// half, counts as that: no exposure makes black bright.
ExposureRange exposure_range(const Image& reference);

/// As flip_map(); not symmetric, for the reference alone decides the exposures.
PixelMap hdr_flip_map(const Image& reference, const Image& test, ThreadPool& pool,
                      double pixels_per_degree = kUsualPixelsPerDegree);

}  // namespace softfocus

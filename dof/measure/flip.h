#pragma once
// FLIP: how different two pictures look to someone who flips between them, 0 (the same)
// to 1, for each pixel.
//
// Source: Andersson and others, "FLIP: A Difference Evaluator for Alternating Images"
// (2020). Colour: both pictures are blurred as the eye blurs them from where it sits
// (contrast sensitivity), clamped to what a screen can show, and their HyAB distance in
// Hunt-adjusted L*a*b* is raised to 0.7 and spread over 0..1: up to 0.4 of the largest
// (green against blue) takes up 0 to 0.95. Features: edges and points of the luminance, by
// the first and second derivative of a Gaussian as wide as the eye's detectors (0.082
// degrees from peak to trough); the larger difference of magnitudes, over sqrt(2), to the
// power of 0.5. Together: colour^(1 - feature).

#include "dof/measure/difference.h"
#include "dof/measure/ssim.h"
#include "dof/measure/tone.h"
#include "raster/images/image.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// Of a screen 0.7 m and 3840 pixels wide, 0.7 m away: 3840 pi / 180.
inline constexpr double kUsualPixelsPerDegree = 67.02064327658226;

/// FLIP of each pixel, 0 to 1; the picture's is the mean. Symmetric. Both RGBA16F and of
/// one size; `tone` gives linear light, not encoded (clamped_tone() for LDR-FLIP).
PixelMap flip_map(const Image& reference, const Image& test, const ToneTable& tone,
                  ThreadPool& pool, double pixels_per_degree = kUsualPixelsPerDegree);

/// The picture's FLIP, of clamped light: that of measure_pictures().
double mean_flip(const Image& reference, const Image& test, ThreadPool& pool);

// The filters of FLIP, each a pass along rows and a pass along columns.

struct FlipFilters {
  /// Contrast sensitivity of the opponent channels (table 1 of the paper):
  /// a sqrt(pi / b) exp(-pi^2 d^2 / b) at d degrees, b = 0.0047 for light and dark, 0.0053
  /// for red and green, and for blue and yellow two terms, a = 34.1 with b = 0.04 and
  /// a = 13.5 with b = 0.025. Each sums to 1.
  FilterTaps achromatic;
  FilterTaps red_green;
  FilterTaps blue_yellow_wide;
  FilterTaps blue_yellow_narrow;
  double wide_share;  ///< of the two terms' sum in two dimensions; the rest is narrow

  /// Features, along the derivative and across it. Positive weights sum to 1, negative
  /// ones to -1; `smooth` sums to 1.
  FilterTaps edge;
  FilterTaps point;
  FilterTaps smooth;

  int margin;  ///< the largest radius
};

/// `pixels_per_degree` > 0.
FlipFilters flip_filters(double pixels_per_degree);

// HDR-FLIP: the largest FLIP of each pixel over all exposures at which something of the
// reference shows.
//
// Source: Andersson, Nilsson, Shirley, Akenine-Moller, "Visualizing Errors in Rendered
// High Dynamic Range Images" (2021). The first exposure takes the reference's largest
// luminance to 0.85 on the film's curve (filmic_tone), the last its median; between them
// as many as there are stops, at least two, at equal distances.

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

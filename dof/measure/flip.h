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

#include "dof/measure/pixel_map.h"
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

}  // namespace softfocus

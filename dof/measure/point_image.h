#pragma once
// A method's picture of one bright point on black: how much of its light is left, and how close
// it is to a disc.

#include "raster/images/image.h"

namespace softfocus {

/// All light in a picture: the sum over pixels of the luminance, not clamped. Infinity
/// counts as the largest half; NaN and what is below 0 count as 0. RGBA16F.
double energy(const Image& image);

/// Where the light of a picture lies. Second moments are of pixel centres; the light of a
/// filled disc of radius r has r^2 / 4 along each axis.
struct PointShape {
  double energy = 0.0;
  double centre_x_px = 0.0;  ///< the pixel (0, 0) has its centre at (0.5, 0.5)
  double centre_y_px = 0.0;
  /// The smaller eigenvalue of the matrix of second moments over the larger: 1 for a shape
  /// equally wide in all directions (a disc, a square, a single pixel), towards 0 for a line.
  double eigenvalue_ratio = 1.0;
  /// Of the disc with these moments: sqrt(2 (larger + smaller)).
  double radius_px = 0.0;
};

/// The shape of the light in a picture. All 0, and the ratio 1, where there is none.
PointShape point_shape(const Image& image);

/// How far a point's image is from the disc of `radius_px` > 0 about its centre that holds
/// the same light: the root of sum((image - disc)^2) / sum(disc^2). 0 for the disc, 1 for an
/// image that spreads its light thinly over everything; NaN for a black image.
double disc_deviation(const Image& image, double radius_px);

/// The part of the pixel (x, y) that a disc covers, 0 to 1, from 16x16 points of it.
double disc_coverage(int x, int y, double centre_x_px, double centre_y_px, double radius_px);

}  // namespace softfocus

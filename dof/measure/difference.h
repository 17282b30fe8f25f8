#pragma once
// How two pictures differ: counted in representable half values, and as PSNR.

#include <array>
#include <cstdint>

#include "raster/images/image.h"

namespace softfocus {

struct Difference {
  std::uint64_t values = 0;     ///< compared: width * height * 4
  std::uint64_t differing = 0;  ///< of them, with other bits (+0 and -0 are equal)
  int max_ulp = 0;              ///< largest distance in half-ULPs (half_ulps_between)
  /// Largest absolute difference of a red, green or blue value, in linear light, not clamped. NaN
  /// or infinity against anything else is infinitely far.
  double max_error = 0.0;
  /// Bucket 0 counts the equal values, bucket k the distances 2^(k-1) to 2^k - 1.
  std::array<std::uint64_t, 17> ulp_histogram{};
  /// Peak signal-to-noise ratio of colour, linear and clamped to 0..1 (peak 1), in
  /// decibels; infinite when equal. A NaN counts as 0.
  double psnr_db = 0.0;
  /// Where the first differing value is, in reading order; -1 if there is none.
  int first_x = -1;
  int first_y = -1;
  int first_channel = -1;
};

/// Both RGBA16F and of one size.
Difference compare_images(const Image& a, const Image& b);

/// Black where the pictures are equal. Else the pixel's largest difference on a logarithmic
/// scale: blue for 1 half-ULP, then green and yellow, to red for 2^15.
Image difference_picture(const Image& a, const Image& b);

}  // namespace softfocus

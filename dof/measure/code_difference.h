#pragma once
// How two pictures differ as files of 8 bits have them, in the codes of the sRGB curve: what other
// programs count.
//
//   AE, MAE, RMSE, PSNR, PAE   ImageMagick's compare; idiff's mean and RMS error, its PSNR, its
//                              largest error: codes over 255, of red, green and blue
//   YIQ                        pixelmatch and odiff: pixels whose colours differ by more than a
//                              threshold (Kotsarenko and Ramos 2010), but for those that are an
//                              anti-aliased edge's in either picture (Vysniauskas 2009)
//
// Alpha is not looked at.

#include <cstdint>

#include "raster/images/image.h"

namespace softfocus {

/// Of two pixels' codes: .5053 y^2 + .299 i^2 + .1957 q^2 of the differences in YIQ. Black against
/// white has kMostYiq.
inline constexpr double kMostYiq = 35215.0;
inline constexpr double kUsualThreshold = 0.1;

struct CodeDifference {
  std::uint64_t pixels = 0;    ///< that differ in any code: AE
  double mean_error = 0.0;     ///< MAE, 0 to 1
  double rms_error = 0.0;      ///< RMSE, 0 to 1
  double psnr_db = 0.0;        ///< -20 log10 of it; infinite if they are equal
  int max_error = 0;           ///< codes, 0 to 255: PAE
  int max_x = -1, max_y = -1;  ///< the first pixel that has it; -1 if they are equal
  std::uint64_t beyond = 0;  ///< pixels beyond the threshold that are no edge's: pixelmatch's count
  std::uint64_t anti_aliased = 0;  ///< beyond it, and an edge's
};

/// Both RGBA16F and of one size. `threshold` is 0 to 1: a pixel is beyond it if its YIQ difference
/// is more than kMostYiq threshold^2.
CodeDifference compare_codes(const Image& a, const Image& b, double threshold = kUsualThreshold);

}  // namespace softfocus

#pragma once
// How two pictures differ: counted in representable half values, and as PSNR.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dof/measure/tone.h"
#include "raster/images/image.h"
#include "raster/threads/parallel.h"

namespace softfocus {

// A number for each pixel: a measure before it is averaged over the picture or a region.

struct PixelMap {
  int width = 0;
  int height = 0;
  std::vector<double> values;  ///< row by row, the top one first
};

inline PixelMap make_pixel_map(int width, int height) {
  return {width, height,
          std::vector<double>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height))};
}

inline std::span<double> row(PixelMap& map, int y) {
  const auto width = static_cast<std::size_t>(map.width);
  return std::span{map.values}.subspan(static_cast<std::size_t>(y) * width, width);
}
inline std::span<const double> row(const PixelMap& map, int y) {
  const auto width = static_cast<std::size_t>(map.width);
  return std::span{map.values}.subspan(static_cast<std::size_t>(y) * width, width);
}

/// The mean of all values, summed in reading order.
inline double mean(const PixelMap& map) {
  double sum = 0.0;
  for (const double value : map.values) sum += value;
  return sum / static_cast<double>(map.values.size());
}

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

/// When two pixels differ: by more than `most` in red, green, blue or, if it is an opacity, alpha,
/// from every pixel of the other picture that lies within `search_px` of the same place.
struct PixelLimit {
  double most = 0.0;
  bool has_opacity = false;
  int search_px = 0;
};

/// How many pixels of either picture differ. Both RGBA16F and of one size. NaN and infinity differ
/// from all that has other bits.
std::uint64_t pixels_beyond(const Image& a, const Image& b, const PixelLimit& limit);

/// Black where the pictures are equal. Else the pixel's largest difference on a logarithmic
/// scale: blue for 1 half-ULP, then green and yellow, to red for 2^15.
Image difference_picture(const Image& a, const Image& b);

// Mean squared error and the peak signal-to-noise ratio that follows from it.

/// For each pixel the mean over red, green and blue of the squared difference of toned
/// values; its mean over pixels is the MSE. Both RGBA16F and of one size.
PixelMap squared_error_map(const Image& a, const Image& b, const ToneTable& tone, ThreadPool& pool);

/// Peak signal-to-noise ratio in decibels for a peak of 1: -10 log10(mse). Infinite for 0, NaN
/// for NaN.
double psnr_db(double mean_squared_error);

}  // namespace softfocus

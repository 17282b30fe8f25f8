#pragma once
// What samples of a picture are added up in.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "raster/images/image.h"
#include "raster/numbers/profile.h"
#include "raster/parallel.h"

namespace softfocus {

/// So many samples are added in binary32 before they go to the sum in binary64: a sixth of
/// the memory traffic, for an error below 2^-21 of the largest. Groups start at multiples of
/// it, so the bits do not depend on who adds.
inline constexpr int kSampleGroup = 8;

/// Linear red, green and blue of each pixel, summed in binary64: 65,536 halves lose nothing
/// that a half could show, where a binary32 sum of equal values can be off by 2^-9 of itself.
struct SampleSums {
  int width = 0;
  int height = 0;
  int count = 0;  ///< samples that are in
  std::size_t stride = 0;
  std::vector<double> totals;  ///< row by row, in each row `stride` reds, greens, blues
};

SampleSums make_sample_sums(int width, int height);

/// Back to no samples, in the same memory.
void clear_sums(SampleSums& sums);

/// One row of a channel, 0 to 2: `width` sums.
std::span<double> sums_row(SampleSums& sums, int y, int channel);
std::span<const double> sums_row(const SampleSums& sums, int y, int channel);

/// Adds one to kSampleGroup RGBA16F pictures of the sums' size, one after the other.
void add_pictures(std::span<const Image> pictures, SampleSums& sums, ThreadPool& pool);

/// The means as RGBA16F, with alpha from `depth`, RGBA16F of that size. Of one picture, that
/// picture. Needs one sample at least.
Image mean_picture(const SampleSums& sums, const Image& depth, const Profile& profile,
                   ThreadPool& pool);

/// The same into a picture of that size.
void store_mean(const SampleSums& sums, const Image& depth, const Profile& profile, Image& picture,
                ThreadPool& pool);

/// The samples of `all` that came after those of `first`. Needs `all` to have begun as `first`.
SampleSums later_samples(const SampleSums& first, const SampleSums& all);

/// How far the first half of the samples and the second lie apart: the root of the mean
/// square, over pixels and colours, of the difference of their means. `first_half` are the
/// sums when they had half as many.
double half_set_rms(const SampleSums& first_half, const SampleSums& all, ThreadPool& pool);

/// add_pictures() of one row without vectors.
void add_row_plain(std::span<const std::uint16_t* const> rows, int width, double* red,
                   double* green, double* blue);

}  // namespace softfocus

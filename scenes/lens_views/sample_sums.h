#pragma once
// What samples of a picture are added up in.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "raster/images/image.h"
#include "raster/numbers/profile.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// So many samples are added in binary32 before they go to the sum in binary64: a sixth of
/// the memory traffic, for an error below 2^-21 of the largest. Groups start at multiples of
/// it, so the bits do not depend on who adds.
inline constexpr int kSampleGroup = 8;

/// The sums lie in tiles of so many pixels a side: what is added tile by tile is one run of
/// memory.
inline constexpr int kSumTile = 64;

/// Linear red, green and blue of each pixel, summed in binary64: 65,536 halves lose nothing
/// that a half could show, where a binary32 sum of equal values can be off by 2^-9 of itself.
struct SampleSums {
  int width = 0;
  int height = 0;
  int count = 0;  ///< samples that are in
  int tiles_x = 0;
  std::vector<double> totals;  ///< four a pixel; alpha's mean nothing
};

SampleSums make_sample_sums(int width, int height);

/// Forgets the samples, and keeps the memory.
void clear_sums(SampleSums& sums);

/// The sums of a pixel, and of those that follow it in its row of its tile.
double* sums_at(SampleSums& sums, int x, int y);
const double* sums_at(const SampleSums& sums, int x, int y);

/// Adds one to kSampleGroup samples, RGBA16F, of `width` pixels of row y from x on, in one
/// tile. The caller counts them.
void add_rows(std::span<const std::uint16_t* const> rows, int x, int y, int width, SampleSums& sums,
              Isa isa);

/// Adds one to kSampleGroup RGBA16F pictures of the sums' size, one after the other.
void add_pictures(std::span<const Image> pictures, SampleSums& sums, ThreadPool& pool);

/// The means as RGBA16F, with alpha from `depth`, RGBA16F of that size. Of one picture, that
/// picture. Needs one sample at least.
Image mean_picture(const SampleSums& sums, const Image& depth, const Profile& profile,
                   ThreadPool& pool);

/// The same into an RGBA16F picture of the sums' size.
void store_mean(const SampleSums& sums, const Image& depth, const Profile& profile, Image& picture,
                ThreadPool& pool);

/// The samples of `all` that came after those of `first`. Needs `all` to have begun as `first`.
SampleSums later_samples(const SampleSums& first, const SampleSums& all);

/// How far the first half of the samples and the second lie apart: the root of the mean
/// square, over pixels and colours, of the difference of their means. `first_half` are the
/// sums when they had half as many.
double half_set_rms(const SampleSums& first_half, const SampleSums& all, ThreadPool& pool);

/// add_rows() of so many halves without vectors.
void add_row_scalar(std::span<const std::uint16_t* const> rows, int halves, double* totals);

}  // namespace softfocus

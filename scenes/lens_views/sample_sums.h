#pragma once
// Sums of a picture's samples.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "raster/images/image.h"
#include "raster/numbers/profile.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// Samples that are added in binary32 before they go to the sum in binary64: a sixth of the
/// memory traffic, for an error below 2^-21 of the largest. Groups start at multiples of it,
/// so that the bits do not depend on who adds.
inline constexpr int kSampleGroup = 8;

/// The side in pixels of the tiles in which the sums lie: each is one run of memory.
inline constexpr int kSumTile = 64;

/// Linear red, green and blue of each pixel. In binary64 the sum of 65,536 halves loses nothing
/// that a half could show; in binary32 a sum of equal values can be off by 2^-9 of itself.
struct SampleSums {
  int width = 0;
  int height = 0;
  int count = 0;  ///< of samples
  int tiles_x = 0;
  std::vector<double> totals;    ///< four a pixel; those of alpha are not used
  std::vector<int> tile_counts;  ///< of samples, where tiles have different ones; else empty
};

SampleSums make_sample_sums(int width, int height);

/// Forgets the samples, and keeps the memory.
void clear_sums(SampleSums& sums);

/// The sums of a pixel. Those of the next pixels in its row of the tile follow.
double* sums_at(SampleSums& sums, int x, int y);
const double* sums_at(const SampleSums& sums, int x, int y);

/// The samples of a pixel.
int count_at(const SampleSums& sums, int x, int y);

/// Adds 1 to kSampleGroup samples, RGBA16F, of the `width` pixels from (x, y) on, which lie in
/// one tile. The caller counts the samples.
void add_rows(std::span<const std::uint16_t* const> rows, int x, int y, int width, SampleSums& sums,
              Isa isa);

/// Adds 1 to kSampleGroup RGBA16F pictures of the sums' size.
void add_pictures(std::span<const Image> pictures, SampleSums& sums, ThreadPool& pool);

/// The means as RGBA16F, with the alpha of `depth`, an RGBA16F picture of that size. Needs at
/// least one sample; the mean of one is that picture.
Image mean_picture(const SampleSums& sums, const Image& depth, const Profile& profile,
                   ThreadPool& pool);

/// mean_picture() into a picture that is there.
void store_mean(const SampleSums& sums, const Image& depth, const Profile& profile, Image& picture,
                ThreadPool& pool);

/// The samples of `all` after those of `first`, with which `all` must begin.
SampleSums later_samples(const SampleSums& first, const SampleSums& all);

/// How far apart the means of the first and the second half of the samples lie: the root of the
/// mean square, over pixels and colours, of their difference. `first_half` are the sums after
/// half of the samples.
double half_set_rms(const SampleSums& first_half, const SampleSums& all, ThreadPool& pool);

/// The root of the mean square, over pixels and colours, of the difference of two means.
double rms_between(const SampleSums& a, const SampleSums& b, ThreadPool& pool);

/// add_rows() without vectors, of `halves` halves.
void add_row_scalar(std::span<const std::uint16_t* const> rows, int halves, double* totals);

}  // namespace softfocus

#ifndef SOFTFOCUS_ISA

#include "scenes/lens_views/sample_sums.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "raster/images/texel.h"

#define SOFTFOCUS_KERNELS "scenes/lens_views/sample_sums.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

// It leaves every number as it is, even -0.
constexpr double kNoLight = -0.0;

constexpr int kChannels = 4;  // of a pixel, alpha too

std::size_t place_of(const SampleSums& sums, int x, int y) {
  const int tile = y / kSumTile * sums.tiles_x + x / kSumTile;
  const int pixel = y % kSumTile * kSumTile + x % kSumTile;
  return (static_cast<std::size_t>(tile) * kSumTile * kSumTile + static_cast<std::size_t>(pixel)) *
         kChannels;
}

}  // namespace

SampleSums make_sample_sums(int width, int height) {
  SampleSums sums{width, height, 0, (width + kSumTile - 1) / kSumTile, {}, {}};
  const int tiles_y = (height + kSumTile - 1) / kSumTile;
  sums.totals.assign(place_of(sums, 0, tiles_y * kSumTile), kNoLight);
  return sums;
}

void clear_sums(SampleSums& sums) {
  sums.count = 0;
  sums.tile_counts.clear();
  std::fill(sums.totals.begin(), sums.totals.end(), kNoLight);
}

int count_at(const SampleSums& sums, int x, int y) {
  if (sums.tile_counts.empty()) return sums.count;
  return sums.tile_counts[static_cast<std::size_t>(y / kSumTile * sums.tiles_x + x / kSumTile)];
}

double* sums_at(SampleSums& sums, int x, int y) {
  return sums.totals.data() + place_of(sums, x, y);
}
const double* sums_at(const SampleSums& sums, int x, int y) {
  return sums.totals.data() + place_of(sums, x, y);
}

void add_row_scalar(std::span<const std::uint16_t* const> rows, int halves, double* totals) {
  for (int i = 0; i < halves; ++i) {
    float sum = half_to_float(rows[0][i]);
    for (const std::uint16_t* row_of_next : rows.subspan(1)) sum += half_to_float(row_of_next[i]);
    totals[i] += static_cast<double>(sum);
  }
}

void add_rows(std::span<const std::uint16_t* const> rows, int x, int y, int width, SampleSums& sums,
              Isa isa) {
  assert(!rows.empty() && rows.size() <= kSampleGroup);
  assert(x / kSumTile == (x + width - 1) / kSumTile);
  double* totals = sums_at(sums, x, y);
  const int halves = kChannels * width;
  int done = 0;
  if (isa != Isa::scalar) {
    done =
        SOFTFOCUS_KERNEL(isa, add_row)(rows.data(), static_cast<int>(rows.size()), halves, totals);
  }
  std::array<const std::uint16_t*, kSampleGroup> rest{};
  for (std::size_t i = 0; i < rows.size(); ++i) rest[i] = rows[i] + done;
  add_row_scalar({rest.data(), rows.size()}, halves - done, totals + done);
}

void add_pictures(std::span<const Image> pictures, SampleSums& sums, ThreadPool& pool) {
  pool.for_each(sums.height, [&](int y) {
    for (int x = 0; x < sums.width; x += kSumTile) {
      std::array<const std::uint16_t*, kSampleGroup> rows{};
      for (std::size_t i = 0; i < pictures.size(); ++i) {
        assert(pictures[i].width == sums.width && pictures[i].height == sums.height);
        rows[i] = row<std::uint16_t>(pictures[i], y).data() + kChannels * x;
      }
      add_rows({rows.data(), pictures.size()}, x, y, std::min(kSumTile, sums.width - x), sums,
               pool.isa());
    }
  });
  sums.count += static_cast<int>(pictures.size());
}

Image mean_picture(const SampleSums& sums, const Image& depth, const Profile& profile,
                   ThreadPool& pool) {
  Image picture = make_image(Format::rgba16f, sums.width, sums.height);
  store_mean(sums, depth, profile, picture, pool);
  return picture;
}

void store_mean(const SampleSums& sums, const Image& depth, const Profile& profile, Image& picture,
                ThreadPool& pool) {
  assert(sums.count > 0);
  assert(picture.width == sums.width && picture.height == sums.height);
  pool.for_each(sums.height, [&](int y) {
    const auto from = row<std::uint16_t>(depth, y);
    const auto to = row<std::uint16_t>(picture, y);
    for (int tile_x = 0; tile_x < sums.width; tile_x += kSumTile) {
      const int end = std::min(tile_x + kSumTile, sums.width);
      const int count = count_at(sums, tile_x, y);
      int x = tile_x;
      if (pool.isa() != Isa::scalar) {
        const auto first = static_cast<std::size_t>(kChannels * x);
        x += SOFTFOCUS_KERNEL(pool.isa(), store_means)(sums_at(sums, x, y), count,
                                                       profile.half_store, &from[first],
                                                       kChannels * (end - x), &to[first]) /
             kChannels;
      }
      for (; x < end; ++x) {
        const auto texel = static_cast<std::size_t>(kChannels * x);
        const double* totals = sums_at(sums, x, y);
        for (std::size_t c = 0; c < 3; ++c) {
          to[texel + c] = float_to_half(static_cast<float>(totals[c] / count), profile.half_store);
        }
        to[texel + 3] = from[texel + 3];
      }
    }
  });
}

SampleSums later_samples(const SampleSums& first, const SampleSums& all) {
  assert(first.count < all.count && first.totals.size() == all.totals.size());
  SampleSums later = all;
  later.count -= first.count;
  for (std::size_t i = 0; i < later.totals.size(); ++i) later.totals[i] -= first.totals[i];
  return later;
}

namespace {

// Sums difference(x, y, colour). Rows first, then their sums in order: the same bits for any number
// of threads.
template <class Difference>
double rms_of(int width, int height, const Difference& difference, ThreadPool& pool) {
  std::vector<double> squares(static_cast<std::size_t>(height));
  pool.for_each(height, [&](int y) {
    double sum = 0.0;
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < 3; ++c) {
        const double apart = difference(x, y, c);
        sum += apart * apart;
      }
    }
    squares[static_cast<std::size_t>(y)] = sum;
  });
  double total = 0.0;
  for (const double of_row : squares) total += of_row;
  return std::sqrt(total / (3.0 * width * height));
}

}  // namespace

double half_set_rms(const SampleSums& first_half, const SampleSums& all, ThreadPool& pool) {
  assert(first_half.count > 0 && 2 * first_half.count == all.count);
  const auto difference = [&](int x, int y, int c) {
    return (2.0 * sums_at(first_half, x, y)[c] - sums_at(all, x, y)[c]) / first_half.count;
  };
  return rms_of(all.width, all.height, difference, pool);
}

double rms_between(const SampleSums& a, const SampleSums& b, ThreadPool& pool) {
  assert(a.count > 0 && b.count > 0 && a.totals.size() == b.totals.size());
  const auto difference = [&](int x, int y, int c) {
    return sums_at(a, x, y)[c] / a.count - sums_at(b, x, y)[c] / b.count;
  };
  return rms_of(a.width, a.height, difference, pool);
}

}  // namespace softfocus

#else  // the kernels, once a vector unit

namespace {

using Doubles [[gnu::vector_size(8 * SOFTFOCUS_LANES)]] = double;
using HalfLanes [[gnu::vector_size(2 * SOFTFOCUS_LANES)]] = std::uint16_t;

}  // namespace

/// add_row_scalar() for whole vectors. Returns how many halves it has added.
int add_row(const std::uint16_t* const* rows, int row_count, int halves, double* totals) {
  int done = 0;
  for (; done + kLanes <= halves; done += kLanes) {
    Floats sum = load_halves(rows[0] + done);
    for (int i = 1; i < row_count; ++i) sum += load_halves(rows[i] + done);
    Doubles total;
    std::memcpy(&total, totals + done, sizeof total);
    total += __builtin_convertvector(sum, Doubles);
    std::memcpy(totals + done, &total, sizeof total);
  }
  return done;
}

namespace {

template <HalfRounding rounding>
int store_means_rounded(const double* totals, int samples, const std::uint16_t* depth, int halves,
                        std::uint16_t* to) {
  const Mask alpha = (lane_numbers() & 3) == 3;
  int done = 0;
  for (; done + kLanes <= halves; done += kLanes) {
    Doubles total;
    std::memcpy(&total, totals + done, sizeof total);
    total /= static_cast<double>(samples);
    const Bits mean = float_to_half<rounding>(__builtin_convertvector(total, Floats));
    HalfLanes texels;
    std::memcpy(&texels, depth + done, sizeof texels);
    texels = __builtin_convertvector(select(alpha, __builtin_convertvector(texels, Bits), mean),
                                     HalfLanes);
    std::memcpy(to + done, &texels, sizeof texels);
  }
  return done;
}

}  // namespace

/// store_mean() for whole vectors of a row. Returns how many halves it has stored.
int store_means(const double* totals, int samples, HalfRounding rounding,
                const std::uint16_t* depth, int halves, std::uint16_t* to) {
  using enum HalfRounding;
  switch (rounding) {
    case nearest_even: return store_means_rounded<nearest_even>(totals, samples, depth, halves, to);
    case toward_zero: return store_means_rounded<toward_zero>(totals, samples, depth, halves, to);
    case swiftshader: break;
  }
  return store_means_rounded<swiftshader>(totals, samples, depth, halves, to);
}

#endif

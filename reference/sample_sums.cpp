#include "reference/sample_sums.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "raster/images/texel.h"

#define SOFTFOCUS_KERNELS "reference/sums_kernels.inl"
#include "raster/numbers/for_each_isa.inl"

namespace softfocus {
namespace {

std::size_t row_start(const SampleSums& sums, int y, int channel) {
  return (static_cast<std::size_t>(y) * 3 + static_cast<std::size_t>(channel)) * sums.stride;
}

}  // namespace

SampleSums make_sample_sums(int width, int height) {
  SampleSums sums{width, height, 0, static_cast<std::size_t>(width), {}};
  sums.totals.resize(sums.stride * 3 * static_cast<std::size_t>(height));
  clear_sums(sums);
  return sums;
}

void clear_sums(SampleSums& sums) {
  sums.count = 0;
  // -0: what it is added to stays as it is, even -0.
  std::fill(sums.totals.begin(), sums.totals.end(), -0.0);
}

std::span<double> sums_row(SampleSums& sums, int y, int channel) {
  return std::span{sums.totals}.subspan(row_start(sums, y, channel), sums.stride);
}

std::span<const double> sums_row(const SampleSums& sums, int y, int channel) {
  return std::span{sums.totals}.subspan(row_start(sums, y, channel), sums.stride);
}

void add_row_plain(std::span<const std::uint16_t* const> rows, int width, double* red,
                   double* green, double* blue) {
  double* const totals[] = {red, green, blue};
  for (int x = 0; x < width; ++x) {
    for (int channel = 0; channel < 3; ++channel) {
      const int at = 4 * x + channel;
      float sum = half_to_float(rows[0][at]);
      for (const std::uint16_t* row_of_next : rows.subspan(1)) {
        sum += half_to_float(row_of_next[at]);
      }
      totals[channel][x] += static_cast<double>(sum);
    }
  }
}

void add_pictures(std::span<const Image> pictures, SampleSums& sums, ThreadPool& pool) {
  assert(!pictures.empty() && pictures.size() <= kSampleGroup);
  pool.for_each(sums.height, [&](int y) {
    std::array<const std::uint16_t*, kSampleGroup> rows{};
    for (std::size_t i = 0; i < pictures.size(); ++i) {
      assert(pictures[i].width == sums.width && pictures[i].height == sums.height);
      rows[i] = row<std::uint16_t>(pictures[i], y).data();
    }
    double* red = sums_row(sums, y, 0).data();
    double* green = sums_row(sums, y, 1).data();
    double* blue = sums_row(sums, y, 2).data();
    int done = 0;
    if (pool.isa() != Isa::scalar) {
      done = SOFTFOCUS_KERNEL(pool.isa(), add_row)(rows.data(), static_cast<int>(pictures.size()),
                                                   sums.width, red, green, blue);
      for (const std::uint16_t*& rest : rows) rest += rest != nullptr ? 4 * done : 0;
    }
    add_row_plain({rows.data(), pictures.size()}, sums.width - done, red + done, green + done,
                  blue + done);
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
    for (int channel = 0; channel < 3; ++channel) {
      const auto totals = sums_row(sums, y, channel);
      for (std::size_t x = 0; x < totals.size(); ++x) {
        const double mean = totals[x] / sums.count;
        to[4 * x + static_cast<std::size_t>(channel)] =
            float_to_half(static_cast<float>(mean), profile.half_store);
      }
    }
    for (std::size_t alpha = 3; alpha < to.size(); alpha += 4) to[alpha] = from[alpha];
  });
}

SampleSums later_samples(const SampleSums& first, const SampleSums& all) {
  assert(first.count < all.count && first.totals.size() == all.totals.size());
  SampleSums later = all;
  later.count -= first.count;
  for (std::size_t i = 0; i < later.totals.size(); ++i) later.totals[i] -= first.totals[i];
  return later;
}

double half_set_rms(const SampleSums& first_half, const SampleSums& all, ThreadPool& pool) {
  assert(first_half.count > 0 && 2 * first_half.count == all.count);
  // A row's own sum, then the rows' in order: the same for any number of threads.
  std::vector<double> squares(static_cast<std::size_t>(all.height));
  pool.for_each(all.height, [&](int y) {
    double sum = 0.0;
    for (int channel = 0; channel < 3; ++channel) {
      const auto half = sums_row(first_half, y, channel);
      const auto whole = sums_row(all, y, channel);
      for (std::size_t x = 0; x < half.size(); ++x) {
        const double difference = (2.0 * half[x] - whole[x]) / first_half.count;
        sum += difference * difference;
      }
    }
    squares[static_cast<std::size_t>(y)] = sum;
  });
  double total = 0.0;
  for (const double of_row : squares) total += of_row;
  return std::sqrt(total / (3.0 * all.width * all.height));
}

}  // namespace softfocus

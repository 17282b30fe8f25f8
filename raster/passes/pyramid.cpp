#ifndef SOFTFOCUS_ISA
// The kernel, below #else, is compiled once for each vector unit (for_each_isa.inl).

#include "raster/passes/pyramid.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <glm/vec4.hpp>
#include <vector>

#include "raster/images/texel.h"
#include "raster/passes/fullscreen_pass.h"
#include "raster/passes/row_sums.h"
#include "raster/threads/scratch_shelf.h"

#define SOFTFOCUS_KERNELS "raster/passes/pyramid.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

constexpr int kBandRows = 32;  ///< rows of the result that a thread takes at a time

bool fit_down(const ConstImageView& source, const ImageView& result) {
  return source.format == Format::rgba16f && result.format == Format::rgba16f &&
         result.width == (source.width + 1) / 2 && result.height == (source.height + 1) / 2;
}

bool fit_up(const ConstImageView& source, const ConstImageView& own, const ImageView& result) {
  return fit_down(own, {source.format, source.width, source.height, 0, nullptr}) &&
         own.width == result.width && own.height == result.height &&
         result.format == Format::rgba16f;
}

float down_weight(int i, int j) {
  const auto distance = [](int k) { return static_cast<std::size_t>(k < 3 ? 2 - k : k - 3); };
  return static_cast<float>(kDownsample128ths[distance(i)][distance(j)]) / 128.0f;
}

float up_weight(int i, bool is_odd) {
  return static_cast<float>(kUpsample16ths[static_cast<std::size_t>(is_odd ? 3 - i : i)]) / 16.0f;
}

/// In the order of downsample(): of a row the columns 0, 2, 4 and then 1, 3, 5.
constexpr std::array kDownColumns{0, 2, 4, 1, 3, 5};

/// A thread's rows of floats.
struct PyramidRows {
  std::vector<float> values, row, own, sums, more_sums;
  std::vector<const float*> rows;
};

/// Pixels of even numbers, then those of odd ones, `half` floats apart.
void split_columns(const float* from, int pixels, float* to, std::size_t half) {
  for (int x = 0; x < pixels; ++x) {
    std::memcpy(to + (x % 2 == 0 ? 0 : half) + static_cast<std::size_t>(x / 2 * 4), from + 4 * x,
                4 * sizeof(float));
  }
}

void downsample_band(const ConstImageView& source, const ImageView& result, const Profile& profile,
                     int first, int end, PyramidRows& rows, Isa isa) {
  std::array<float, 36> weights;
  for (int j = 0; j < 6; ++j) {
    for (int i = 0; i < 6; ++i) {
      weights[static_cast<std::size_t>(6 * j + i)] =
          down_weight(kDownColumns[static_cast<std::size_t>(i)], j);
    }
  }
  const int values = 4 * result.width, pixels = 2 * result.width + 4;
  const std::size_t half = static_cast<std::size_t>(values + 8 + kValuesAtOnce);
  rows.row.resize(static_cast<std::size_t>(4 * pixels));
  rows.values.resize(12 * half);
  rows.sums.resize(half);
  rows.rows.resize(12);
  const auto place = [&](int y) {
    return &rows.values[static_cast<std::size_t>((y + 6) % 6) * 2 * half];
  };
  const auto take = [&](int y) {
    decode_row(row<std::uint16_t>(source, std::clamp(y, 0, source.height - 1)), -2, pixels,
               rows.row.data(), isa);
    split_columns(rows.row.data(), pixels, place(y), half);
  };
  for (int y = 2 * first - 2; y < 2 * first + 2; ++y) take(y);
  for (int y = first; y < end; ++y) {
    take(2 * y + 2);
    take(2 * y + 3);
    for (int j = 0; j < 6; ++j) {
      rows.rows[static_cast<std::size_t>(2 * j)] = place(2 * y - 2 + j);
      rows.rows[static_cast<std::size_t>(2 * j + 1)] = place(2 * y - 2 + j) + half;
    }
    sum_rows({rows.rows.data(), 12, 3, weights.data()}, values, rows.sums.data(), isa);
    store_row(rows.sums.data(), nullptr, values, profile.half_store,
              row<std::uint16_t>(result, y).data(), isa);
  }
}

struct UpsampleWork {
  const ConstImageView& source;
  const ConstImageView& own;
  float share;
  const ImageView& result;
  const Profile& profile;
  Isa isa;
};

void upsample_band(const UpsampleWork& work, int first, int end, PyramidRows& rows) {
  const int half_width = work.source.width, values = 4 * half_width, pixels = half_width + 4;
  const std::size_t length = static_cast<std::size_t>(4 * pixels + kValuesAtOnce);
  rows.values.resize(4 * length);
  rows.rows.resize(4);
  rows.sums.resize(length);
  rows.more_sums.resize(length);
  rows.row.resize(static_cast<std::size_t>(2 * values + kMostLanes));
  rows.own.resize(rows.row.size());
  const auto place = [&](int y) {
    return &rows.values[static_cast<std::size_t>(y + 4) % 4 * length];
  };
  const auto take = [&](int y) {
    decode_row(row<std::uint16_t>(work.source, std::clamp(y, 0, work.source.height - 1)), -2,
               pixels, place(y), work.isa);
  };
  const auto top_of = [](int y) { return y / 2 - 2 + y % 2; };
  for (int y = top_of(first); y < top_of(first) + 3; ++y) take(y);
  int taken = top_of(first) + 3;
  for (int y = first; y < end; ++y) {
    const int top = top_of(y);
    for (; taken < top + 4; ++taken) take(taken);
    std::array<float, 16> even, odd;
    for (int j = 0; j < 4; ++j) {
      for (int i = 0; i < 4; ++i) {
        const auto at = static_cast<std::size_t>(4 * j + i);
        even[at] = up_weight(i, false) * up_weight(j, y % 2 != 0);
        odd[at] = up_weight(i, true) * up_weight(j, y % 2 != 0);
      }
      rows.rows[static_cast<std::size_t>(j)] = place(top + j);
    }
    sum_rows({rows.rows.data(), 4, 4, even.data()}, values, rows.sums.data(), work.isa);
    for (const float*& row : rows.rows) row += 4;
    sum_rows({rows.rows.data(), 4, 4, odd.data()}, values, rows.more_sums.data(), work.isa);
    for (int x = 0; x < work.result.width; ++x) {
      const float* from = (x % 2 == 0 ? rows.sums : rows.more_sums).data() + x / 2 * 4;
      std::memcpy(&rows.row[static_cast<std::size_t>(4 * x)], from, 4 * sizeof(float));
    }
    const int count = 4 * work.result.width;
    const auto own = row<std::uint16_t>(work.own, y);
    decode_row(own, 0, work.result.width, rows.own.data(), work.isa);
    SOFTFOCUS_KERNEL(work.isa, mix_row)(rows.own.data(), rows.row.data(), work.share, count);
    store_row(rows.row.data(), nullptr, count, work.profile.half_store,
              row<std::uint16_t>(work.result, y).data(), work.isa);
  }
}

}  // namespace

void downsample_oracle(const ConstImageView& source, const ImageView& result,
                       const Profile& profile, ThreadPool& pool) {
  assert(fit_down(source, result));
  fullscreen_pass<Format::rgba16f>(result, profile, pool, [&](int x, int y) {
    glm::vec4 sum{0.0f};
    for (int j = 0; j < 6; ++j) {
      for (const int i : kDownColumns) {
        sum += down_weight(i, j) *
               load_texel<Format::rgba16f>(source, std::clamp(2 * x - 2 + i, 0, source.width - 1),
                                           std::clamp(2 * y - 2 + j, 0, source.height - 1));
      }
    }
    return sum;
  });
}

void downsample(const ConstImageView& source, const ImageView& result, const Profile& profile,
                ThreadPool& pool) {
  assert(fit_down(source, result));
  if (pool.isa() == Isa::scalar) return downsample_oracle(source, result, profile, pool);
  ScratchShelf<PyramidRows> shelf;
  pool.for_each((result.height + kBandRows - 1) / kBandRows, [&](int band) {
    PyramidRows rows = shelf.take();
    downsample_band(source, result, profile, band * kBandRows,
                    std::min((band + 1) * kBandRows, result.height), rows, pool.isa());
    shelf.put_back(std::move(rows));
  });
}

void upsample_oracle(const ConstImageView& source, const ConstImageView& own, float share,
                     const ImageView& result, const Profile& profile, ThreadPool& pool) {
  assert(fit_up(source, own, result));
  fullscreen_pass<Format::rgba16f>(result, profile, pool, [&](int x, int y) {
    const bool odd_x = x % 2 != 0, odd_y = y % 2 != 0;
    glm::vec4 sum{0.0f};
    for (int j = 0; j < 4; ++j) {
      for (int i = 0; i < 4; ++i) {
        sum += up_weight(i, odd_x) * up_weight(j, odd_y) *
               load_texel<Format::rgba16f>(
                   source, std::clamp(x / 2 - 2 + (odd_x ? 1 : 0) + i, 0, source.width - 1),
                   std::clamp(y / 2 - 2 + (odd_y ? 1 : 0) + j, 0, source.height - 1));
      }
    }
    const glm::vec4 here = load_texel<Format::rgba16f>(own, x, y);
    return here + share * (sum - here);
  });
}

void upsample(const ConstImageView& source, const ConstImageView& own, float share,
              const ImageView& result, const Profile& profile, ThreadPool& pool) {
  assert(fit_up(source, own, result));
  if (pool.isa() == Isa::scalar) return upsample_oracle(source, own, share, result, profile, pool);
  const UpsampleWork work{source, own, share, result, profile, pool.isa()};
  ScratchShelf<PyramidRows> shelf;
  pool.for_each((result.height + kBandRows - 1) / kBandRows, [&](int band) {
    PyramidRows rows = shelf.take();
    upsample_band(work, band * kBandRows, std::min((band + 1) * kBandRows, result.height), rows);
    shelf.put_back(std::move(rows));
  });
}

}  // namespace softfocus

#else  // the kernel

/// sums[i] = own[i] + share * (sums[i] - own[i]), up to a whole vector.
void mix_row(const float* own, float* sums, float share, int values) {
  for (int i = 0; i < values; i += kLanes) {
    const Floats here = load(own + i);
    store(sums + i, here + share * (load(sums + i) - here));
  }
}

#endif

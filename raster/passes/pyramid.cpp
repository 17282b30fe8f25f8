#ifndef SOFTFOCUS_ISA
// The kernel, below #else, is compiled once for each vector unit (for_each_isa.inl).

#include "raster/passes/pyramid.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <utility>
#include <vector>

#include "raster/images/image.h"
#include "raster/passes/row_sums.h"
#include "raster/threads/loops.h"

#define SOFTFOCUS_KERNELS "raster/passes/pyramid.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

constexpr int kPyramidRows = 32;  ///< rows of the result that a thread takes at a time

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

float up_weight(Widening widening, int i, bool is_odd) {
  const auto& sixteenths = widening == Widening::tent ? kTent16ths : kBilinear16ths;
  return static_cast<float>(sixteenths[static_cast<std::size_t>(is_odd ? 3 - i : i)]) / 16.0f;
}

/// The first of the four along an axis that counts.
int first_tap(Widening widening) { return widening == Widening::tent ? 0 : 1; }

/// In the order of downsample(): of a row the columns 0, 2, 4 and then 1, 3, 5.
constexpr std::array kDownColumns{0, 2, 4, 1, 3, 5};

/// A thread's rows of floats.
struct PyramidRows {
  std::vector<float> values, row, own, sums, more_sums;
  std::vector<std::uint16_t> made, stored;
  std::vector<const float*> rows;
};

/// Pixels of even numbers, then those of odd ones, `half` floats apart.
void split_columns(const float* from, int pixels, float* to, std::size_t half) {
  for (int x = 0; x < pixels; ++x) {
    std::memcpy(to + (x % 2 == 0 ? 0 : half) + static_cast<std::size_t>(x / 2 * 4), from + 4 * x,
                4 * sizeof(float));
  }
}

/// `row_of(y)` is a row of the source, or of what lies beyond its edges.
template <class RowOf>
void downsample_band(const RowOf& row_of, const ImageView& result, const Profile& profile,
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
    decode_row(row_of(y), -2, pixels, rows.row.data(), isa);
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
  int width;  ///< of the result
  const Upsampling& how;
  const Profile& profile;
  Isa isa;
};

/// `row_of(y)` is a row of what the result is mixed with; store(y, row) rounds a row of the result.
template <class RowOf, class Store>
void upsample_band(const UpsampleWork& work, const RowOf& row_of, const Store& store_at, int first,
                   int end, PyramidRows& rows) {
  const Widening widening = work.how.widening;
  const int tap = first_tap(widening);
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
    std::size_t at = 0;
    for (int j = tap; j < 4 - tap; ++j) {
      const float down = up_weight(widening, j, y % 2 != 0);
      for (int i = tap; i < 4 - tap; ++i, ++at) {
        even[at] = up_weight(widening, i, false) * down;
        odd[at] = up_weight(widening, i, true) * down;
      }
      rows.rows[static_cast<std::size_t>(j - tap)] = place(top + j) + 4 * tap;
    }
    const int taps = 4 - 2 * tap;
    sum_rows({rows.rows.data(), taps, taps, even.data()}, values, rows.sums.data(), work.isa);
    for (int j = 0; j < taps; ++j) rows.rows[static_cast<std::size_t>(j)] += 4;
    sum_rows({rows.rows.data(), taps, taps, odd.data()}, values, rows.more_sums.data(), work.isa);
    for (int x = 0; x < work.width; ++x) {
      const float* from = (x % 2 == 0 ? rows.sums : rows.more_sums).data() + x / 2 * 4;
      std::memcpy(&rows.row[static_cast<std::size_t>(4 * x)], from, 4 * sizeof(float));
    }
    const int count = 4 * work.width;
    decode_row(row_of(y), 0, work.width, rows.own.data(), work.isa);
    if (!work.how.alone) {
      SOFTFOCUS_KERNEL(work.isa, mix_row)(rows.own.data(), rows.row.data(), work.how.share, count);
    }
    store_at(y, [&](std::uint16_t* to) {
      store_row(rows.row.data(), work.how.alone ? rows.own.data() : nullptr, count,
                work.profile.half_store, to, work.isa);
    });
  }
}

/// Calls band(first, end, rows) for bands of a result's rows, on all threads.
template <class Band>
void for_bands(int height, ThreadPool& pool, const Band& band) {
  for_each_band_with<PyramidRows>(pool, height, kPyramidRows, band);
}

}  // namespace

void downsample(const ConstImageView& source, const ImageView& result, const Profile& profile,
                ThreadPool& pool) {
  assert(fit_down(source, result));
  for_bands(result.height, pool, [&](int first, int end, PyramidRows& rows) {
    const auto row_of = [&](int y) {
      return row<std::uint16_t>(source, std::clamp(y, 0, source.height - 1));
    };
    downsample_band(row_of, result, profile, first, end, rows, pool.isa());
  });
}

namespace {

/// A row of made ones in a thread's memory.
std::span<const std::uint16_t> made_row(const MadeRows& source, int y, PyramidRows& rows) {
  rows.made.resize(4 * static_cast<std::size_t>(source.width));
  source.make(std::clamp(y, 0, source.height - 1), rows.made.data());
  return rows.made;
}

}  // namespace

void downsample_made(const MadeRows& source, const ImageView& result, const Profile& profile,
                     ThreadPool& pool) {
  for_bands(result.height, pool, [&](int first, int end, PyramidRows& rows) {
    downsample_band([&](int y) { return made_row(source, y, rows); }, result, profile, first, end,
                    rows, pool.isa());
  });
}

void upsample(const ConstImageView& source, const ConstImageView& own, const Upsampling& how,
              const ImageView& result, const Profile& profile, ThreadPool& pool) {
  assert(fit_up(source, own, result));
  const UpsampleWork work{source, result.width, how, profile, pool.isa()};
  for_bands(result.height, pool, [&](int first, int end, PyramidRows& rows) {
    upsample_band(
        work, [&](int y) { return row<std::uint16_t>(own, y); },
        [&](int y, const auto& store) { store(row<std::uint16_t>(result, y).data()); }, first, end,
        rows);
  });
}

void upsample_made(const ConstImageView& source, const MadeRows& own, const Upsampling& how,
                   const TakeRow& take, const Profile& profile, ThreadPool& pool) {
  const UpsampleWork work{source, own.width, how, profile, pool.isa()};
  for_bands(own.height, pool, [&](int first, int end, PyramidRows& rows) {
    rows.stored.resize(4 * static_cast<std::size_t>(own.width));
    upsample_band(
        work, [&](int y) { return made_row(own, y, rows); },
        [&](int y, const auto& store) {
          store(rows.stored.data());
          take(y, rows.stored.data());
        },
        first, end, rows);
  });
}

void dual_filter(int levels, Widening widening, const ConstImageView& picture,
                 const ImageView& result, const Profile& profile, ThreadPool& pool) {
  assert(levels >= 1);
  std::vector<Image> halves;
  ConstImageView above = picture;
  for (int i = 0; i < levels; ++i) {
    halves.push_back(make_image(Format::rgba16f, (above.width + 1) / 2, (above.height + 1) / 2));
    downsample(above, halves.back(), profile, pool);
    above = halves.back();
  }
  const Upsampling how{.widening = widening, .alone = true};
  for (std::size_t i = halves.size() - 1; i > 0; --i) {
    Image wider = make_image(Format::rgba16f, halves[i - 1].width, halves[i - 1].height);
    upsample(halves[i], halves[i - 1], how, wider, profile, pool);
    halves[i - 1] = std::move(wider);
  }
  upsample(halves[0], picture, how, result, profile, pool);
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

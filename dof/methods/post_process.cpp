#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).
// There is no scalar form: Isa::scalar runs the baseline kernels, which need no vector unit.

#include "dof/methods/post_process.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "dof/picture_planes.h"
#include "raster/numbers/exact_math.h"
#include "raster/threads/loops.h"

namespace softfocus {

// A row of full resolution to blend.
struct PostProcessRow {
  // Red of the two rows above, the row itself and the two below, with two more pixels at
  // either end.
  const float* sharp[5];
  std::ptrdiff_t sharp_plane;
  const float* radius;
  // Enlarged: medium's red, green, blue and near radius, large's red, green and blue.
  const float* blurred;
  std::ptrdiff_t blurred_plane;
  int count;
  float squares[4];   // R_i^2
  float inverses[4];  // 1 / (R_i^2 - R_(i-1)^2), from 1 on
  float* result;
  std::ptrdiff_t result_plane;
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "dof/methods/post_process.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

constexpr int kQuarter = 4;
constexpr int kNear = 3;  // the plane of the near radius, after the colours
constexpr int kTaskRows = 8;

// Variances along an axis, in square pixels: that of a mean of 4x4 pixels, and what
// enlarging adds.
constexpr double kMeanVariance = 1.25;
constexpr double kEnlargedVariance = 2.5;
constexpr double kMediumVariance = kMeanVariance + 8.0 + kEnlargedVariance;
constexpr double kSmallVariance = 24.0 / 17.0;

Planes make_quarter(const Planes& full, ThreadPool& pool) {
  Planes quarter = make_planes(4, (full.width + kQuarter - 1) / kQuarter,
                               (full.height + kQuarter - 1) / kQuarter, pool);
  pool.for_each(quarter.height, [&](int y) {
    float* to = plane_row(quarter, 0, y);
    for (int x = 0; x < quarter.stride; ++x) {
      std::array<float, 3> sum{};
      float near = 0.0f;
      for (int i = 0; i < kQuarter; ++i) {
        const float* from = plane_row(full, 0, std::min(kQuarter * y + i, full.height - 1));
        for (int j = 0; j < kQuarter; ++j) {
          const int column = std::min(kQuarter * x + j, full.width - 1);
          for (int c = 0; c < 3; ++c) {
            sum[static_cast<std::size_t>(c)] += from[c * full.plane + column];
          }
          const float radius = -from[3 * full.plane + column];
          near = std::max(near, radius > 0.5f ? radius : 0.0f);
        }
      }
      for (int c = 0; c < 3; ++c) {
        to[c * quarter.plane + x] = sum[static_cast<std::size_t>(c)] / (kQuarter * kQuarter);
      }
      to[kNear * quarter.plane + x] = near;
    }
  });
  return quarter;
}

// An odd number of weights from end to end, which sum to 1.
std::vector<float> gaussian_weights(double variance) {
  const int reach = static_cast<int>(std::ceil(3.0 * std::sqrt(variance)));
  std::vector<double> exact;
  double sum = 0.0;
  for (int i = -reach; i <= reach; ++i) {
    const double log2_of_e = 1.4426950408889634;
    exact.push_back(i == 0 ? 1.0 : exact_math::exp2(-0.5 * i * i / variance * log2_of_e));
    sum += exact.back();
  }
  std::vector<float> weights;
  weights.reserve(exact.size());
  for (const double weight : exact) weights.push_back(static_cast<float>(weight / sum));
  return weights;
}

// Convolves all planes along x, then along y. The edges repeat outwards.
Planes convolve(const Planes& source, const std::vector<float>& weights, ThreadPool& pool) {
  const int taps = static_cast<int>(weights.size()), reach = taps / 2;
  Planes across = make_planes(4, source.width, source.height, pool);
  Planes result = make_planes(4, source.width, source.height, pool);
  pool.for_each(source.height, [&](int y) {
    std::vector<float> padded(static_cast<std::size_t>(source.width + 2 * reach + kMostLanes));
    std::vector<const float*> rows;
    rows.reserve(weights.size());
    for (int i = 0; i < taps; ++i) rows.push_back(padded.data() + i);
    for (int c = 0; c < 4; ++c) {
      const float* from = plane_row(source, c, y);
      std::fill_n(padded.begin(), reach, from[0]);
      std::copy_n(from, source.width, padded.begin() + reach);
      std::fill(padded.begin() + reach + source.width, padded.end(), from[source.width - 1]);
      SOFTFOCUS_KERNEL(pool.isa(), weigh_rows)
      (rows.data(), weights.data(), taps, source.width, plane_row(across, c, y));
    }
  });
  pool.for_each(source.height, [&](int y) {
    std::vector<const float*> rows(static_cast<std::size_t>(taps));
    for (int c = 0; c < 4; ++c) {
      for (int i = 0; i < taps; ++i) {
        rows[static_cast<std::size_t>(i)] =
            plane_row(std::as_const(across), c, std::clamp(y + i - reach, 0, source.height - 1));
      }
      SOFTFOCUS_KERNEL(pool.isa(), weigh_rows)
      (rows.data(), weights.data(), taps, source.width, plane_row(result, c, y));
    }
  });
  return result;
}

// Interpolates a row of full resolution bilinearly. `blended` has room for a row of `quarter`
// and one more pixel at either end.
void enlarge_row(const Planes& quarter, int plane, int y, int width, float* blended, float* to) {
  constexpr std::array kOtherShares{0.375f, 0.125f, 0.125f, 0.375f};
  const int inside = y / kQuarter, part = y % kQuarter;
  const int other = std::clamp(part < 2 ? inside - 1 : inside + 1, 0, quarter.height - 1);
  const float share = kOtherShares[static_cast<std::size_t>(part)];
  const float* own_row = plane_row(quarter, plane, inside);
  const float* other_row = plane_row(quarter, plane, other);
  for (int x = 0; x < quarter.width; ++x) {
    blended[x + 1] = own_row[x] + share * (other_row[x] - own_row[x]);
  }
  blended[0] = blended[1];
  blended[quarter.width + 1] = blended[quarter.width];
  for (int x = 0; x < width; x += kQuarter) {
    const float* own = blended + x / kQuarter + 1;
    const float before = own[-1] - own[0], after = own[1] - own[0];
    to[x] = own[0] + 0.375f * before;
    to[x + 1] = own[0] + 0.125f * before;
    to[x + 2] = own[0] + 0.125f * after;
    to[x + 3] = own[0] + 0.375f * after;
  }
}

// Copies a row of the scene's colours, with two more pixels at either end.
void pad_row(const Planes& full, int y, float* to, std::ptrdiff_t plane) {
  for (int c = 0; c < 3; ++c, to += plane) {
    const float* from = plane_row(full, c, y);
    std::fill_n(to, 2, from[0]);
    std::copy_n(from, full.width, to + 2);
    std::fill(to + 2 + full.width, to + plane, from[full.width - 1]);
  }
}

void blend(const DofInput& input, const ImageView& result, const Planes& full, const Planes& medium,
           const Planes& large, double largest_square, ThreadPool& pool) {
  PostProcessRow pattern{};
  const std::array squares{0.25, 4.0 * kSmallVariance, 4.0 * kMediumVariance, largest_square};
  for (std::size_t i = 0; i < squares.size(); ++i) {
    pattern.squares[i] = static_cast<float>(squares[i]);
    if (i > 0) pattern.inverses[i] = static_cast<float>(1.0 / (squares[i] - squares[i - 1]));
  }
  pattern.count = full.width;
  const std::ptrdiff_t length = full.stride + 2 * kMostLanes;
  pattern.sharp_plane = pattern.blurred_plane = pattern.result_plane = length;
  for_each_band(pool, full.height, kTaskRows, [&](int first, int end) {
    std::vector<float> sharp(static_cast<std::size_t>((kTaskRows + 4) * 3 * length));
    std::vector<float> blurred(static_cast<std::size_t>(8 * length));
    std::vector<float> out(static_cast<std::size_t>(3 * length));
    for (int y = first - 2; y < end + 2; ++y) {
      pad_row(full, std::clamp(y, 0, full.height - 1),
              &sharp[static_cast<std::size_t>((y - first + 2) * 3 * length)], length);
    }
    for (int y = first; y < end; ++y) {
      float* blended = blurred.data() + 7 * length;
      for (int c = 0; c < 4; ++c) {
        enlarge_row(medium, c, y, full.width, blended, blurred.data() + c * length);
      }
      for (int c = 0; c < 3; ++c) {
        enlarge_row(large, c, y, full.width, blended, blurred.data() + (4 + c) * length);
      }
      PostProcessRow row = pattern;
      for (int i = 0; i < 5; ++i) {
        row.sharp[i] = sharp.data() + (y - first + i) * 3 * length + 2;
      }
      row.radius = plane_row(full, 3, y);
      row.blurred = blurred.data();
      row.result = out.data();
      SOFTFOCUS_KERNEL(pool.isa(), blend_row)(row);
      store_row(input, result, y, row.result, row.result + length, row.result + 2 * length,
                pool.isa());
    }
  });
}

}  // namespace

void post_process(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  const Planes full = split_picture(input, pool);
  Planes quarter = make_quarter(full, pool);
  const double max_coc = static_cast<double>(input.settings.max_coc_px);
  const double largest_square = std::max(max_coc * max_coc, 4.0 * kMediumVariance + 4.0);
  const Planes large = convolve(
      quarter, gaussian_weights((largest_square / 4.0 - kMeanVariance - kEnlargedVariance) / 16.0),
      pool);
  pool.for_each(quarter.height, [&](int y) {
    float* near = plane_row(quarter, kNear, y);
    const float* blurred = plane_row(large, kNear, y);
    for (int x = 0; x < quarter.width; ++x) {
      near[x] = 2.0f * std::max(blurred[x], near[x]) - near[x];
    }
  });
  const Planes medium = convolve(quarter, {0.25f, 0.5f, 0.25f}, pool);
  blend(input, result, full, medium, large, largest_square, pool);
}

}  // namespace softfocus

#else  // kernels

/// The weighted sum of `taps` rows.
void weigh_rows(const float* const* rows, const float* weights, int taps, int count, float* to) {
  for (int x = 0; x < count; x += kLanes) {
    Floats sum = load(rows[0] + x) * weights[0];
    for (int i = 1; i < taps; ++i) sum = sum + load(rows[i] + x) * weights[i];
    store(to + x, sum);
  }
}

namespace {

#include "dof/picture_lanes.inl"

/// The sum of a square of four pixels, four times the bilinear tap in its middle. `upper` and
/// `lower` point at its left pixels.
SOFTFOCUS_INLINE Floats square_sum(const float* upper, const float* lower) {
  return (load(upper) + load(upper + 1)) + (load(lower) + load(lower + 1));
}

}  // namespace

void blend_row(const PostProcessRow& row) {
  for (int x = 0; x < row.count; x += kLanes) {
    const Floats near = load(row.blurred + 3 * row.blurred_plane + x);
    const Floats radius = larger(load(row.radius + x), near);
    const Floats square = larger(radius, splat(0.0f)) * larger(radius, splat(0.0f));
    Floats shares[4];
    for (int i = 1; i < 4; ++i) {
      shares[i] = saturate((square - row.squares[i - 1]) * row.inverses[i]);
    }
    for (int c = 0; c < 3; ++c) {
      const float* at[5];
      for (int i = 0; i < 5; ++i) at[i] = row.sharp[i] + c * row.sharp_plane + x;
      const Floats own = load(at[2]);
      const Floats taps = (square_sum(at[0], at[1]) + square_sum(at[1] - 2, at[2] - 2)) +
                          (square_sum(at[3] - 1, at[4] - 1) + square_sum(at[2] + 1, at[3] + 1));
      const Floats small = (own + taps) * (1.0f / 17.0f);
      const Floats medium = load(row.blurred + c * row.blurred_plane + x);
      const Floats large = load(row.blurred + (4 + c) * row.blurred_plane + x);
      store(row.result + c * row.result_plane + x,
            mix(mix(mix(own, small, shares[1]), medium, shares[2]), large, shares[3]));
    }
  }
}

#endif

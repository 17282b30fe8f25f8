#ifndef SOFTFOCUS_ISA
// The kernel, below #else, is compiled once for each vector unit (for_each_isa.inl).

#include "raster/passes/bilateral.h"

#include <algorithm>
#include <cassert>
#include <vector>

#include "raster/images/texel.h"
#include "raster/passes/kernel.h"
#include "raster/threads/loops.h"

namespace softfocus {

/// A row of the result, from rows of the source in planes of red, green, blue and alpha.
struct BilateralRow {
  const float* const*
      rows;              ///< 2 reach + 1 of them, red, from the first pixel's first neighbour on
  std::ptrdiff_t plane;  ///< floats from colour to colour
  const float* weights;
  int reach;
  float colour_factor, depth_tolerance;
  int width;
  float* result;  ///< red, green, blue, each `result_plane` floats, up to whole vectors
  std::ptrdiff_t result_plane;
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "raster/passes/bilateral.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

/// Rows that a thread takes at a time. It splits those above and below once more.
constexpr int kBandRows = 32;

bool fit(const ConstImageView& source, const ImageView& result) {
  return source.format == Format::rgba16f && result.format == Format::rgba16f &&
         source.width == result.width && source.height == result.height;
}

/// `count` pixels from column `first` on, which may lie beyond the row, in planes.
void split_row(std::span<const std::uint16_t> from, int first, int count, float* to,
               std::ptrdiff_t plane) {
  const int last = static_cast<int>(from.size() / 4) - 1;
  for (int x = 0; x < count; ++x) {
    const std::uint16_t* texel = from.data() + 4 * std::clamp(first + x, 0, last);
    for (int c = 0; c < 4; ++c) to[c * plane + x] = half_to_float(texel[c]);
  }
}

/// A thread's memory: the rows around one, in a ring.
struct SplitRows {
  std::vector<float> values;
  std::vector<const float*> rows;
  std::vector<float> result;
};

struct BilateralWork {
  const BilateralSettings& settings;
  const std::vector<float>& weights;
  const ConstImageView& source;
  const ImageView& result;
  const Profile& profile;
  Isa isa;
};

void filter_band(const BilateralWork& work, int first, int end, SplitRows& ring) {
  const int reach = static_cast<int>(work.weights.size() / 2), height = 2 * reach + 1;
  const int width = work.source.width, columns = width + 2 * reach;
  const std::ptrdiff_t plane = columns + kMostLanes, result_plane = width + kMostLanes;
  ring.values.resize(static_cast<std::size_t>(4 * plane * height));
  ring.rows.resize(static_cast<std::size_t>(height));
  ring.result.resize(static_cast<std::size_t>(3 * result_plane));
  const int top = first - reach;
  const auto place = [&](int y) { return ring.values.data() + (y - top) % height * 4 * plane; };
  const auto split = [&](int y) {
    split_row(row<std::uint16_t>(work.source, std::clamp(y, 0, work.source.height - 1)), -reach,
              columns, place(y), plane);
  };
  for (int y = top; y < first + reach; ++y) split(y);
  for (int y = first; y < end; ++y) {
    split(y + reach);
    for (int j = 0; j < height; ++j) {
      ring.rows[static_cast<std::size_t>(j)] = place(y - reach + j);
    }
    SOFTFOCUS_KERNEL(work.isa, bilateral_row)
    ({ring.rows.data(), plane, work.weights.data(), reach, bilateral_colour_factor(work.settings),
      work.settings.depth_tolerance, width, ring.result.data(), result_plane});
    const float* own = place(y) + 3 * plane + reach;
    for (int x = 0; x < width; ++x) {
      const float* colour = ring.result.data() + x;
      store_texel<Format::rgba16f>(
          work.result, x, y, {colour[0], colour[result_plane], colour[2 * result_plane], own[x]},
          work.profile);
    }
  }
}

}  // namespace

float bilateral_colour_factor(const BilateralSettings& settings) {
  const float tolerance = settings.colour_tolerance;
  return tolerance > 0.0f ? 1.0f / (tolerance * tolerance) : 0.0f;
}

void bilateral(const BilateralSettings& settings, const ConstImageView& source,
               const ImageView& result, const Profile& profile, ThreadPool& pool) {
  assert(fit(source, result));
  const std::vector<float> weights = gaussian_weights(settings.sigma_px);
  const BilateralWork work{settings, weights, source, result, profile, pool.isa()};
  for_each_band_with<SplitRows>(
      pool, result.height, kBandRows,
      [&](int first, int end, auto& rows) { filter_band(work, first, end, rows); });
}

}  // namespace softfocus

#else  // the kernel

namespace {

SOFTFOCUS_INLINE Floats likeness_lanes(Floats square) {
  const Floats rest = 1.0f - square;
  return select(rest > 0.0f, rest * rest, splat(0.0f));
}

}  // namespace

void bilateral_row(const BilateralRow& row) {
  const std::ptrdiff_t plane = row.plane;
  for (int x = 0; x < row.width; x += kLanes) {
    const float* centre = row.rows[row.reach] + row.reach + x;
    const Floats own_r = load(centre), own_g = load(centre + plane);
    const Floats own_b = load(centre + 2 * plane);
    const Floats own_a = smaller(splat(kFarthestDepth), load(centre + 3 * plane));
    const Floats depth_scale = row.depth_tolerance * own_a;
    Floats r = splat(0.0f), g = r, b = r, sum_of_weights = r;
    for (int j = 0; j <= 2 * row.reach; ++j) {
      const float* other = row.rows[j] + x;
      for (int i = 0; i <= 2 * row.reach; ++i, ++other) {
        const Floats other_r = load(other), other_g = load(other + plane);
        const Floats other_b = load(other + 2 * plane);
        Floats weight = splat(row.weights[i] * row.weights[j]);
        if (i != row.reach || j != row.reach) {
          const Floats off_r = other_r - own_r, off_g = other_g - own_g, off_b = other_b - own_b;
          weight *=
              likeness_lanes((off_r * off_r + off_g * off_g + off_b * off_b) * row.colour_factor);
          if (row.depth_tolerance > 0.0f) {
            const Floats depth = smaller(splat(kFarthestDepth), load(other + 3 * plane));
            const Floats ratio = (depth - own_a) / depth_scale;
            weight *= likeness_lanes(ratio * ratio);
          }
        }
        r += weight * other_r;
        g += weight * other_g;
        b += weight * other_b;
        sum_of_weights += weight;
      }
    }
    store(row.result + x, r / sum_of_weights);
    store(row.result + row.result_plane + x, g / sum_of_weights);
    store(row.result + 2 * row.result_plane + x, b / sum_of_weights);
  }
}

#endif

#ifndef SOFTFOCUS_ISA
// The kernel, below #else, is compiled once for each vector unit (for_each_isa.inl).

#include "raster/temporal/reproject.h"

#include <algorithm>
#include <cassert>
#include <vector>

#include "raster/images/image.h"
#include "raster/passes/fullscreen_pass.h"
#include "raster/temporal/split_texels.h"
#include "raster/threads/loops.h"

namespace softfocus {

/// A row of the result. Planes begin with pixel -1.
struct ReprojectRow {
  const float* depths[3];  ///< of the rows above, of and below the row; null above: no neighbours
  const float* motions_x[3];
  const float* motions_y[3];
  const std::int32_t* before;  ///< two words a texel
  const float* frames;
  std::int32_t before_stride, frames_stride;  ///< in texels
  int width, height, y;
  float depth_tolerance;
  bool is_cubic;
  float* result[4];  ///< planes, up to whole vectors
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "raster/temporal/reproject.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

/// Rows that a thread takes at a time; it splits one above and one below once more.
constexpr int kReprojectRows = 32;

[[maybe_unused]] bool fit_together(const ReprojectInput& input, const ImageView& result) {
  const auto fits = [&](const ConstImageView& image, Format format) {
    return image.format == format && image.width == result.width && image.height == result.height;
  };
  return fits(input.depths, Format::rgba16f) && fits(input.velocity, Format::rg16f) &&
         fits(input.before, Format::rgba16f) && fits(input.frames, Format::r32f) &&
         fits(result, Format::rgba16f);
}

/// A thread's memory: the rows around one in a ring, and a row of the result.
struct ReprojectScratch {
  std::vector<float> rows;
  std::vector<float> result;
};

struct ReprojectWork {
  const ReprojectSettings& settings;
  const ReprojectInput& input;
  const ImageView& result;
  const Profile& profile;
  Isa isa;
};

/// Planes of a row in the ring: red, green, blue and depth of the frame, motion along x and y.
constexpr int kReprojectPlanes = 6;

void reproject_band(const ReprojectWork& work, int first, int end, ReprojectScratch& scratch) {
  const ReprojectInput& input = work.input;
  const int width = work.result.width, height = work.result.height;
  const std::ptrdiff_t plane = plane_floats(width);
  scratch.rows.resize(static_cast<std::size_t>(3 * kReprojectPlanes * plane));
  scratch.result.resize(static_cast<std::size_t>(4 * plane));
  const auto place = [&](int y) {
    return scratch.rows.data() + (y + 3) % 3 * kReprojectPlanes * plane;
  };
  const auto split = [&](int y) {
    const int inside = std::clamp(y, 0, height - 1);
    split_texels(input.depths, inside, 4, place(y), work.isa);
    split_texels(input.velocity, inside, 2, place(y) + 4 * plane, work.isa);
  };
  ReprojectRow row_work{};
  row_work.before = reinterpret_cast<const std::int32_t*>(input.before.texels);
  row_work.frames = reinterpret_cast<const float*>(input.frames.texels);
  row_work.before_stride = static_cast<std::int32_t>(input.before.stride_bytes / 8);
  row_work.frames_stride = static_cast<std::int32_t>(input.frames.stride_bytes / 4);
  row_work.width = width;
  row_work.height = height;
  row_work.depth_tolerance = used_depth_tolerance(work.settings);
  row_work.is_cubic = work.settings.is_cubic;
  for (int c = 0; c < 4; ++c) row_work.result[c] = scratch.result.data() + c * plane;
  split(first - 1);
  split(first);
  for (int y = first; y < end; ++y) {
    split(y + 1);
    row_work.y = y;
    for (int j = 0; j < 3; ++j) {
      const float* planes = place(y - 1 + j);
      row_work.depths[j] = planes + 3 * plane;
      row_work.motions_x[j] = planes + 4 * plane;
      row_work.motions_y[j] = planes + 5 * plane;
    }
    if (!work.settings.takes_neighbours) row_work.depths[0] = nullptr;
    SOFTFOCUS_KERNEL(work.isa, reproject_row)(row_work);
    join_texels(row_work.result, width, work.profile.half_store,
                row<std::uint16_t>(work.result, y).data(), work.isa);
  }
}

}  // namespace

float used_depth_tolerance(const ReprojectSettings& settings) {
  constexpr float kAnyDepth = 0x1p100f;
  return settings.depth_tolerance > 0.0f ? settings.depth_tolerance : kAnyDepth;
}

void reverse_reproject(const ReprojectSettings& settings, const ReprojectInput& input,
                       const ImageView& result, const Profile& profile, ThreadPool& pool) {
  assert(fit_together(input, result));
  assert(input.before.stride_bytes % 8 == 0 && input.frames.stride_bytes % 4 == 0);
  const ReprojectWork work{settings, input, result, profile, pool.isa()};
  for_each_band_with<ReprojectScratch>(
      pool, result.height, kReprojectRows,
      [&](int first, int end, auto& scratch) { reproject_band(work, first, end, scratch); });
}

void put_depths(const ConstImageView& drawn, const ImageView& found, const Profile& profile,
                ThreadPool& pool) {
  assert(drawn.format == Format::rgba16f && found.format == Format::rgba16f);
  assert(drawn.width == found.width && drawn.height == found.height);
  for_each_band(pool, found.height, kPassRows, [&](int first, int end) {
    const std::ptrdiff_t plane = plane_floats(found.width);
    std::vector<float> both(static_cast<std::size_t>(8 * plane));
    float* of_found = both.data();
    float* of_drawn = of_found + 4 * plane;
    const float* const planes[] = {of_found + 1, of_found + plane + 1, of_found + 2 * plane + 1,
                                   of_found + 3 * plane + 1};
    const float* const depths = of_drawn + 3 * plane + 1;
    float* const counts = of_found + 3 * plane + 1;
    for (int y = first; y < end; ++y) {
      split_texels(found, y, 4, of_found, pool.isa());
      split_texels(drawn, y, 4, of_drawn, pool.isa());
      for (int x = 0; x < found.width; ++x) counts[x] = counts[x] > 0.0f ? depths[x] : counts[x];
      join_texels(planes, found.width, profile.half_store, row<std::uint16_t>(found, y).data(),
                  pool.isa());
    }
  });
}

}  // namespace softfocus

#else  // the kernel

namespace {

SOFTFOCUS_INLINE Floats compared_depths(Floats depth) {
  return smaller(splat(kFarthestDepth), depth);
}

struct TapSums {
  Floats r, g, b, frames, weights;
};

struct DepthLimits {
  Floats low, high;
};

struct TexelLanes {
  Floats r, g, b;
  Mask counts;  ///< in the picture, and at such a depth
  Ints x, y;    ///< the nearest in the picture
};

SOFTFOCUS_INLINE TexelLanes load_before(const ReprojectRow& row, Ints column, Ints line,
                                        const DepthLimits& limits) {
  const Ints x = larger(smaller(column, splat(row.width - 1)), splat(0));
  const Ints y = larger(smaller(line, splat(row.height - 1)), splat(0));
  const IntPairs words = gather_pairs(row.before, y * row.before_stride + x);
  const Bits first = as_bits(words.first), second = as_bits(words.second);
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
  const HalfTexels texel{first >> 16, first & 0xFFFFu, second >> 16, second & 0xFFFFu};
#else
  const HalfTexels texel{first & 0xFFFFu, first >> 16, second & 0xFFFFu, second >> 16};
#endif
  const Floats depth = compared_depths(half_to_float(texel.a));
  const Mask counts = (x == column) & (y == line) & (depth >= limits.low) & (depth <= limits.high);
  return {half_to_float(texel.r), half_to_float(texel.g), half_to_float(texel.b), counts, x, y};
}

/// Adds the pixels (column, line) if `wanted`.
SOFTFOCUS_INLINE void add_tap(const ReprojectRow& row, Ints column, Ints line, Floats weight,
                              Mask wanted, const DepthLimits& limits, TapSums& sums) {
  const TexelLanes texel = load_before(row, column, line, limits);
  const Mask counts = wanted & texel.counts & (weight > 0.0f);
  const Floats frames = gather(row.frames, texel.y * row.frames_stride + texel.x, counts);
  const Floats none = splat(0.0f);
  sums.r += select(counts, weight * texel.r, none);
  sums.g += select(counts, weight * texel.g, none);
  sums.b += select(counts, weight * texel.b, none);
  sums.frames += select(counts, weight * frames, none);
  sums.weights += select(counts, weight, none);
}

struct CubicWeights {
  Floats of[4];
};

SOFTFOCUS_INLINE CubicWeights cubic_weights_lanes(Floats s) {
  return {{s * (s * (1.0f - s * 0.5f) - 0.5f), s * s * (s * 1.5f - 2.5f) + 1.0f,
           s * (s * (2.0f - s * 1.5f) + 0.5f), s * s * (s * 0.5f - 0.5f)}};
}

/// Puts the curve's colour in place of the first results if `wanted` and all 4x4 pixels count.
SOFTFOCUS_INLINE void take_curve(const ReprojectRow& row, Ints column, Ints line, Floats s,
                                 Floats t, Mask wanted, const DepthLimits& limits, Floats* colour) {
  const CubicWeights of_columns = cubic_weights_lanes(s), of_rows = cubic_weights_lanes(t);
  Floats r = splat(0.0f), g = r, b = r;
  Mask counts = wanted;
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i) {
      const TexelLanes texel = load_before(row, column + (i - 1), line + (j - 1), limits);
      const Floats weight = of_columns.of[i] * of_rows.of[j];
      counts &= texel.counts;
      r += weight * texel.r;
      g += weight * texel.g;
      b += weight * texel.b;
    }
  }
  const Floats none = splat(0.0f);
  colour[0] = select(counts, select(r > none, r, none), colour[0]);
  colour[1] = select(counts, select(g > none, g, none), colour[1]);
  colour[2] = select(counts, select(b > none, b, none), colour[2]);
}

}  // namespace

void reproject_row(const ReprojectRow& row) {
  for (int x = 0; x < row.width; x += kLanes) {
    const Floats own = compared_depths(load(row.depths[1] + x + 1));
    Floats least = own, most = own;
    Floats motion_x = load(row.motions_x[1] + x + 1), motion_y = load(row.motions_y[1] + x + 1);
    if (row.depths[0] != nullptr) {
      least = most = compared_depths(load(row.depths[0] + x));
      motion_x = load(row.motions_x[0] + x);
      motion_y = load(row.motions_y[0] + x);
      for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) {
          const Floats depth = compared_depths(load(row.depths[j] + x + i));
          const Mask nearer = depth < least;
          least = select(nearer, depth, least);
          motion_x = select(nearer, load(row.motions_x[j] + x + i), motion_x);
          motion_y = select(nearer, load(row.motions_y[j] + x + i), motion_y);
          most = select(depth > most, depth, most);
        }
      }
    }
    const DepthLimits limits{least - row.depth_tolerance * least,
                             most + row.depth_tolerance * most};
    const Floats u = to_floats(x + lane_numbers()) - motion_x;
    const Floats v = splat(static_cast<float>(row.y)) - motion_y;
    const Mask wanted = (u > -1.0f) & (v > -1.0f) & (u < static_cast<float>(row.width)) &
                        (v < static_cast<float>(row.height));
    const Floats safe_u = select(wanted, u, splat(0.0f)), safe_v = select(wanted, v, splat(0.0f));
    const Floats column = floor(safe_u), line = floor(safe_v);
    const Floats s = safe_u - column, t = safe_v - line;
    const Ints i = truncate(column), j = truncate(line);
    const Floats rest_s = 1.0f - s, rest_t = 1.0f - t;
    const Floats none = splat(0.0f);
    TapSums sums{none, none, none, none, none};
    add_tap(row, i, j, rest_s * rest_t, wanted, limits, sums);
    add_tap(row, i + 1, j, s * rest_t, wanted, limits, sums);
    add_tap(row, i, j + 1, rest_s * t, wanted, limits, sums);
    add_tap(row, i + 1, j + 1, s * t, wanted, limits, sums);
    const Mask seen = sums.weights > 0.0f;
    Floats colour[] = {select(seen, sums.r / sums.weights, none),
                       select(seen, sums.g / sums.weights, none),
                       select(seen, sums.b / sums.weights, none)};
    const Mask between = wanted & ((s > 0.0f) | (t > 0.0f));
    if (row.is_cubic && any(between)) take_curve(row, i, j, s, t, between, limits, colour);
    for (int c = 0; c < 3; ++c) store(row.result[c] + x, colour[c]);
    store(row.result[3] + x, select(seen, sums.frames / sums.weights, none));
  }
}

#endif

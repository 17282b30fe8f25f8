#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "dof/scatter/aperture_scatter.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "dof/picture_planes.h"
#include "dof/scatter/aperture_stamps.h"
#include "dof/scatter/slabs.h"
#include "raster/images/image.h"
#include "raster/threads/float_environment.h"
#include "raster/threads/loops.h"

#define SOFTFOCUS_KERNELS "dof/scatter/aperture_scatter.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

constexpr int kStampTaskRows = 8;

// A slab with less than this has nothing: the least share of the largest stamp is above it, and
// what rounding leaves of a stamp below.
constexpr double kNothing = 1e-12;

// The light that every pixel spreads, its stamp and its slab.
struct StampSources {
  int width, height;
  ApertureStamps stamps{};
  std::vector<float> light{};  // of a pixel: red, green, blue and weight
  std::vector<std::uint32_t> stamp{};
  std::vector<std::uint8_t> slab{};
  std::vector<int> reach{};              // of a row: rows that its largest stamp reaches
  std::vector<std::uint32_t> in_slab{};  // of a row: a bit for each slab that it has pixels in

  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
};

// A row of the picture: red, green, blue and radius, `stride` apart.
struct PictureRow {
  std::ptrdiff_t stride;
  std::vector<float> values;

  PictureRow(const DofInput& input, int y, Isa isa)
      : stride(plane_stride(input.scene.width)), values(static_cast<std::size_t>(4 * stride)) {
    split_picture_row(input, y, values.data(), stride, static_cast<int>(stride), isa);
  }
  float at(int channel, int x) const {
    return values[static_cast<std::size_t>(channel * stride + x)];
  }
};

StampSources make_stamp_sources(const DofInput& input, ThreadPool& pool) {
  const Aperture& aperture = input.settings.aperture;
  StampSources sources{input.scene.width, input.scene.height};
  const std::size_t pixels = sources.at(0, sources.height);
  const bool upside_down_differs = differs_upside_down(aperture);
  sources.stamp.resize(pixels);
  pool.for_each(sources.height, [&](int y) {
    const PictureRow row{input, y, pool.isa()};
    for (int x = 0; x < sources.width; ++x) {
      sources.stamp[sources.at(x, y)] = stamp_number(row.at(3, x), upside_down_differs);
    }
  });
  sources.stamps = make_stamps(sources.stamp, aperture, pool);
  sources.light.resize(4 * pixels);
  sources.slab.resize(pixels);
  sources.reach.resize(static_cast<std::size_t>(sources.height));
  sources.in_slab.resize(static_cast<std::size_t>(sources.height));
  pool.for_each(sources.height, [&](int y) {
    const PictureRow row{input, y, pool.isa()};
    std::uint32_t in_slab = 0;
    int reach = 0;
    for (int x = 0; x < sources.width; ++x) {
      const std::size_t at = sources.at(x, y);
      const Stamp& stamp = sources.stamps.stamps[sources.stamp[at]];
      const int slab = slab_of(row.at(3, x));
      float* light = &sources.light[4 * at];
      for (int i = 0; i < 3; ++i) light[i] = row.at(i, x) * stamp.weight;
      light[3] = stamp.weight;
      sources.slab[at] = static_cast<std::uint8_t>(slab);
      in_slab |= 1u << slab;
      reach = std::max(reach, static_cast<int>(stamp.reach));
    }
    sources.reach[static_cast<std::size_t>(y)] = reach;
    sources.in_slab[static_cast<std::size_t>(y)] = in_slab;
  });
  return sources;
}

struct StampBuffers {
  // Slab by slab, with a margin on either side; no four numbers across two cache lines.
  std::vector<double, RowAllocator<double>> differences;
  std::vector<float> colour;
};

// The numbers of the slabs of a set, the nearest first.
struct SlabList {
  std::array<int, kSlabs> slabs{};
  int count = 0;
};
SlabList slabs_in(std::uint32_t set) {
  SlabList list;
  for (int slab = 0; slab < kSlabs; ++slab) {
    if ((set >> slab & 1u) != 0) list.slabs[static_cast<std::size_t>(list.count++)] = slab;
  }
  return list;
}

}  // namespace

void scatter_aperture(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  const DefaultFloatEnvironment environment;
  const StampSources sources = make_stamp_sources(input, pool);
  const int width = sources.width, height = sources.height;
  const int margin = sources.stamps.reach;
  const std::ptrdiff_t slab_stride = 4 * (static_cast<std::ptrdiff_t>(width) + 2 * margin);
  const std::ptrdiff_t padded = plane_stride(width);
  const int most_reach = *std::max_element(sources.reach.begin(), sources.reach.end());
  for_each_row_with<StampBuffers>(pool, height, kStampTaskRows, [&](int y, auto& buffers) {
    buffers.differences.resize(static_cast<std::size_t>(slab_stride * kSlabs));
    buffers.colour.resize(static_cast<std::size_t>(3 * padded));
    double* differences = buffers.differences.data();
    float* colour = buffers.colour.data();
    std::uint32_t in_slab = 0;
    for (int from = std::max(y - most_reach, 0); from <= std::min(y + most_reach, height - 1);
         ++from) {
      const auto row = static_cast<std::size_t>(from);
      if (sources.reach[row] < std::max(y - from, from - y)) continue;
      in_slab |= sources.in_slab[row];
      const std::size_t at = sources.at(0, from);
      SOFTFOCUS_KERNEL(pool.isa(), stamp_row)
      (&sources.light[4 * at], &sources.stamp[at], &sources.slab[at], width, y - from,
       sources.stamps.stamps.data(), sources.stamps.rows.data(), sources.stamps.differences.data(),
       differences + std::ptrdiff_t{4} * margin, slab_stride);
    }
    const SlabList used = slabs_in(in_slab);
    std::array<std::array<double, 4>, kSlabs> sums{};
    for (int x = -margin; x < width; ++x) {
      Over over;
      int before = 0;
      for (int i = 0; i < used.count; ++i) {
        const int slab = used.slabs[static_cast<std::size_t>(i)];
        const double* change = differences + slab * slab_stride + std::ptrdiff_t{4} * (x + margin);
        std::array<double, 4>& sum = sums[static_cast<std::size_t>(i)];
        for (std::size_t j = 0; j < 4; ++j) sum[j] += change[j];
        if (x < 0) continue;
        if (slab != before + 1) over.previous = 0.0;
        before = slab;
        if (sum[3] < kNothing) {
          over.previous = 0.0;
        } else {
          add_slab(over, sum, 1.0);
        }
      }
      if (x < 0) continue;
      const SlabColour out = resolve(over);
      colour[x] = out.r;
      colour[padded + x] = out.g;
      colour[2 * padded + x] = out.b;
    }
    for (int i = 0; i < used.count; ++i) {
      std::fill_n(differences + used.slabs[static_cast<std::size_t>(i)] * slab_stride, slab_stride,
                  0.0);
    }
    store_row(input, result, y, colour, colour + padded, colour + 2 * padded, pool.isa());
  });
}

}  // namespace softfocus

#else  // kernels

namespace {

using StampLight [[gnu::vector_size(16)]] = float;
using StampSums [[gnu::vector_size(32)]] = double;

SOFTFOCUS_INLINE void add_run(double* at, const StampSums& light, const float* differences,
                              int count) {
  for (int i = 0; i < count; ++i, at += 4) {
    StampSums sums;
    std::memcpy(&sums, at, sizeof sums);
    sums += light * static_cast<double>(differences[i]);
    std::memcpy(at, &sums, sizeof sums);
  }
}

}  // namespace

/// Adds the stamps of a row of `count` pixels, `dy` rows below which the row of differences lies in
/// each slab. `to` points at the first pixel's place in slab 0.
void stamp_row(const float* light, const std::uint32_t* numbers, const std::uint8_t* slab,
               int count, int dy, const Stamp* stamps, const StampRow* rows,
               const float* differences, double* to, std::ptrdiff_t slab_stride) {
  for (int x = 0; x < count; ++x) {
    const Stamp& stamp = stamps[numbers[x]];
    if (dy > stamp.reach || -dy > stamp.reach) continue;
    const StampRow& row = rows[stamp.row + dy];
    StampLight values;
    std::memcpy(&values, light + 4 * x, sizeof values);
    const StampSums exact = __builtin_convertvector(values, StampSums);
    double* middle = to + slab[x] * slab_stride + 4 * x;
    const float* run = differences + row.first;
    add_run(middle + 4 * row.left_at, exact, run, row.left);
    add_run(middle + 4 * row.right_at, exact, run + row.left, row.right);
  }
}

#endif

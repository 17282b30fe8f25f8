#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "dof/scatter/scatter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "dof/picture_planes.h"
#include "dof/scatter/scatter_discs.h"
#include "dof/scatter/slabs.h"
#include "raster/images/image.h"
#include "raster/threads/loops.h"

#define SOFTFOCUS_KERNELS "dof/scatter/scatter.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

constexpr int kScatterRows = 8;

int slab_of(SlabRule rule, float radius_px) {
  return rule == SlabRule::one ? 0 : softfocus::slab_of(radius_px);
}

int slab_count(SlabRule rule) { return rule == SlabRule::one ? 1 : kSlabs; }

// Red, green, blue and weight.
using Light = std::array<std::uint64_t, 4>;

// The light that every pixel spreads, its disc and its slab.
struct Sources {
  int width, height;
  ScatterDiscs discs;
  std::vector<float> light;  // of a pixel: four numbers, as in Light
  std::vector<std::uint16_t> disc;
  std::vector<std::uint8_t> slab;
  std::vector<int> reach;              // of a row: rows that its largest disc reaches
  std::vector<std::uint32_t> in_slab;  // of a row: a bit for each slab that it has pixels in

  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
};

Sources make_sources(const DofInput& input, SlabRule rule, ThreadPool& pool) {
  const Planes planes = split_picture(input, pool);
  const std::vector<float> largest = largest_of_rows(planes, 3, pool);
  Sources sources{planes.width,
                  planes.height,
                  make_discs(*std::max_element(largest.begin(), largest.end())),
                  {},
                  {},
                  {},
                  {},
                  {}};
  const std::size_t pixels = sources.at(0, sources.height);
  sources.light.resize(4 * pixels);
  sources.disc.resize(pixels);
  sources.slab.resize(pixels);
  sources.reach.resize(largest.size());
  sources.in_slab.resize(largest.size());
  pool.for_each(sources.height, [&](int y) {
    const float* from = plane_row(planes, 0, y);
    std::uint32_t in_slab = 0;
    for (int x = 0; x < sources.width; ++x) {
      const float radius = from[3 * planes.plane + x];
      const int disc = disc_of(radius);
      const int slab = slab_of(rule, radius);
      const float weight = sources.discs.weights[static_cast<std::size_t>(disc)] * kUnitsOfLight;
      const std::size_t at = sources.at(x, y);
      float* light = &sources.light[4 * at];
      for (int i = 0; i < 3; ++i) light[i] = from[i * planes.plane + x] * weight;
      light[3] = weight;
      sources.disc[at] = static_cast<std::uint16_t>(disc);
      sources.slab[at] = static_cast<std::uint8_t>(slab);
      in_slab |= 1u << slab;
    }
    const auto row = static_cast<std::size_t>(y);
    sources.reach[row] = sources.discs.reaches[static_cast<std::size_t>(disc_of(largest[row]))];
    sources.in_slab[row] = in_slab;
  });
  return sources;
}

void add_slab(Over& over, const Light& light) {
  if (light[3] == 0) {
    over.previous = 0.0;
    return;
  }
  std::array<double, 4> numbers{};
  for (std::size_t i = 0; i < 4; ++i) {
    numbers[i] = static_cast<double>(static_cast<std::int64_t>(light[i]));
  }
  add_slab(over, numbers, 0x1p-34);
}

}  // namespace

void scatter_in_slabs_oracle(const DofInput& input, const ImageView& result, SlabRule rule,
                             ThreadPool& pool) {
  const Sources sources = make_sources(input, rule, pool);
  const int width = sources.width, height = sources.height;
  const int slabs = slab_count(rule);
  pool.for_each(height, [&](int y) {
    if (!input.kept.has_row(y)) return;
    std::vector<Light> sums(static_cast<std::size_t>(width) * static_cast<std::size_t>(slabs));
    for (int from_y = 0; from_y < height; ++from_y) {
      const int dy = std::abs(from_y - y);
      if (dy > sources.discs.reach) continue;
      for (int from_x = 0; from_x < width; ++from_x) {
        const std::size_t at = sources.at(from_x, from_y);
        const DiscSpan span =
            sources.discs
                .spans[static_cast<std::size_t>(dy * sources.discs.count) + sources.disc[at]];
        const int reach = span.whole + 1;
        for (int x = std::max(from_x - reach, 0); x <= std::min(from_x + reach, width - 1); ++x) {
          Light& sum = sums[static_cast<std::size_t>(sources.slab[at] * width + x)];
          for (std::size_t i = 0; i < 4; ++i) {
            const double light = sources.light[4 * at + i];
            const std::uint64_t all = whole_units(light),
                                end = whole_units(light * (0.125 * span.eighths));
            const bool inside = std::abs(x - from_x) < reach;
            sum[i] += inside ? all : reach == 0 ? end + end - all : end;
          }
        }
      }
    }
    std::vector<float> colour(3 * static_cast<std::size_t>(width));
    for (int x = 0; x < width; ++x) {
      Over over;
      for (int slab = 0; slab < slabs; ++slab) {
        add_slab(over, sums[static_cast<std::size_t>(slab * width + x)]);
      }
      const SlabColour out = resolve(over);
      const auto at = static_cast<std::size_t>(x), step = static_cast<std::size_t>(width);
      colour[at] = out.r;
      colour[at + step] = out.g;
      colour[at + 2 * step] = out.b;
    }
    store_row(input, result, y, colour.data(), colour.data() + width, colour.data() + 2 * width,
              Isa::scalar);
  });
}

namespace {

struct SlabRows {
  // Slab by slab, with a margin on either side; no four numbers across two cache lines.
  std::vector<std::uint64_t, RowAllocator<std::uint64_t>> differences;
  std::vector<float> colour;
};

void scatter_lanes(const DofInput& input, const ImageView& result, SlabRule rule,
                   ThreadPool& pool) {
  const Sources sources = make_sources(input, rule, pool);
  const int width = sources.width, height = sources.height;
  const int margin = sources.discs.reach + 3;
  const std::ptrdiff_t slab_stride = 4 * (static_cast<std::ptrdiff_t>(width) + 2 * margin);
  const std::ptrdiff_t padded = plane_stride(width);
  const auto discs = static_cast<std::size_t>(sources.discs.count);
  for_each_row_with<SlabRows>(pool, height, kScatterRows, [&](int y, auto& buffers) {
    buffers.differences.resize(static_cast<std::size_t>(slab_stride) *
                               static_cast<std::size_t>(slab_count(rule)));
    buffers.colour.resize(static_cast<std::size_t>(3 * padded));
    std::uint64_t* differences = buffers.differences.data();
    float* colour = buffers.colour.data();
    if (!input.kept.has_row(y)) return;
    std::uint32_t in_slab = 0;
    for (int from = std::max(y - sources.discs.reach, 0);
         from <= std::min(y + sources.discs.reach, height - 1); ++from) {
      const int dy = std::abs(from - y);
      if (sources.reach[static_cast<std::size_t>(from)] < dy) continue;
      in_slab |= sources.in_slab[static_cast<std::size_t>(from)];
      const std::size_t at = sources.at(0, from);
      SOFTFOCUS_KERNEL(pool.isa(), scatter_row)
      (&sources.light[4 * at], &sources.disc[at], &sources.slab[at], width,
       &sources.discs.spans[static_cast<std::size_t>(dy) * discs], differences + 4 * margin,
       slab_stride);
    }
    std::array<int, kSlabs> used;
    std::array<Light, kSlabs> sums{};
    int count = 0;
    for (int slab = 0; slab < kSlabs; ++slab) {
      if ((in_slab >> slab & 1u) != 0) used[static_cast<std::size_t>(count++)] = slab;
    }
    for (int x = -margin; x < width; ++x) {
      Over over;
      int before = 0;
      for (int i = 0; i < count; ++i) {
        const int slab = used[static_cast<std::size_t>(i)];
        const std::uint64_t* change = differences + slab * slab_stride + 4 * (x + margin);
        Light& sum = sums[static_cast<std::size_t>(i)];
        for (std::size_t j = 0; j < 4; ++j) sum[j] += change[j];
        if (x < 0) continue;
        if (slab != before + 1) over.previous = 0.0;
        before = slab;
        add_slab(over, sum);
      }
      if (x < 0) continue;
      const SlabColour out = resolve(over);
      colour[x] = out.r;
      colour[padded + x] = out.g;
      colour[2 * padded + x] = out.b;
    }
    for (int i = 0; i < count; ++i) {
      std::fill_n(differences + used[static_cast<std::size_t>(i)] * slab_stride, slab_stride,
                  std::uint64_t{0});
    }
    store_row(input, result, y, colour, colour + padded, colour + 2 * padded, pool.isa());
  });
}

}  // namespace

void scatter_in_slabs(const DofInput& input, const ImageView& result, SlabRule rule,
                      ThreadPool& pool) {
  (pool.isa() == Isa::scalar ? scatter_in_slabs_oracle : scatter_lanes)(input, result, rule, pool);
}

void scatter_unsorted(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  scatter_in_slabs(input, result, SlabRule::one, pool);
}
void scatter_sorted(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  scatter_in_slabs(input, result, SlabRule::doubling, pool);
}

}  // namespace softfocus

#else  // kernels

namespace {

#include "dof/scatter/scatter_spans.inl"

}  // namespace

/// Adds the spans of a row of `count` pixels to a row of differences in each slab. `spans` are
/// those of all discs at the |dy| between the two rows; `differences` points at the first
/// pixel's place in slab 0.
void scatter_row(const float* light, const std::uint16_t* disc, const std::uint8_t* slab, int count,
                 const DiscSpan* spans, std::uint64_t* differences, std::ptrdiff_t slab_stride) {
  for (int x = 0; x < count; ++x) {
    const DiscSpan span = spans[disc[x]];
    if (span.whole < -1) continue;
    add_span(differences + slab[x] * slab_stride + 4 * x, light + 4 * x, span);
  }
}

#endif

#ifndef SOFTFOCUS_ISA

#include "scenes/filtered_views/spread_tile.h"

#include <algorithm>
#include <array>

#include "raster/images/texel.h"
#include "scenes/filtered_views/cell_levels.h"

namespace softfocus {
namespace {

constexpr std::size_t kSpreadTexelHalves = 4;
constexpr std::ptrdiff_t kSpreadPlane = std::ptrdiff_t{kSpreadRows} * kSpreadStride;
constexpr std::ptrdiff_t kSumPlane = std::ptrdiff_t{kSpreadTile} * kSpreadTile;

// The first cell of a tile among those around it.
constexpr int kFirstCellX = kMostSpreadStep / kCellWidth;
constexpr int kFirstCellY = kMostSpreadStep / kCellHeight;

// A run of pixels of a row in lanes, or one by one.
struct UnpackedRow {
  float *r, *g, *b;
  std::int32_t* level;
};

// A cell's rows and what its rays look at.
struct CellWork {
  const float* colours;        // of its first pixel
  const std::int32_t* levels;  // the same
  const std::int32_t* offsets;
  const std::int32_t* sought;
  const RayRuns* runs;
  int sought_count, rays;
  int width, rows;
  bool begin;
  float* sums;
};

}  // namespace
}  // namespace softfocus

#define SOFTFOCUS_KERNELS "scenes/filtered_views/spread_tile.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

void unpack_scalar(const std::uint16_t* texels, int count, const UnpackedRow& to) {
  for (int i = 0; i < count; ++i) {
    const std::uint16_t* texel = texels + kSpreadTexelHalves * static_cast<std::size_t>(i);
    to.r[i] = half_to_float(texel[0]);
    to.g[i] = half_to_float(texel[1]);
    to.b[i] = half_to_float(texel[2]);
    to.level[i] = texel[3];
  }
}

void unpack(const std::uint16_t* texels, int count, const UnpackedRow& to, Isa isa) {
  if (isa == Isa::scalar) {
    unpack_scalar(texels, count, to);
  } else {
    SOFTFOCUS_KERNEL(isa, unpack_texels)(texels, count, to);
  }
}

UnpackedRow row_at(SpreadMemory& memory, int x, int y) {
  const std::ptrdiff_t at = y * std::ptrdiff_t{kSpreadStride} + x;
  float* first = memory.colours.get() + at;
  return {first, first + kSpreadPlane, first + 2 * kSpreadPlane, memory.levels.get() + at};
}

void repeat_pixel(SpreadMemory& memory, int from_x, int to_x, int count, int y) {
  const UnpackedRow from = row_at(memory, from_x, y), to = row_at(memory, to_x, y);
  std::fill_n(to.r, count, *from.r);
  std::fill_n(to.g, count, *from.g);
  std::fill_n(to.b, count, *from.b);
  std::fill_n(to.level, count, *from.level);
}

// The tile's pixel (0, 0) comes to (kMostSpreadStep, kMostSpreadStep).
void unpack_around(const ViewTiles& view, int tile_x, int tile_y, int reach, SpreadMemory& memory,
                   Isa isa) {
  const int left = tile_x * kSpreadTile, top = tile_y * kSpreadTile;
  const int right = left + tile_width(view, tile_x), bottom = top + tile_height(view, tile_y);
  const int x_begin = std::max(left - reach, 0), x_end = std::min(right + reach, view.width);
  for (int y = top - reach; y < bottom + reach; ++y) {
    const int inside = std::clamp(y, 0, view.height - 1);
    const int row = y - top + kMostSpreadStep;
    for (int x = x_begin; x < x_end;) {
      const int of_x = x / kSpreadTile;
      const int of_y = inside / kSpreadTile;
      const int width = tile_width(view, of_x);
      const int end = std::min(of_x * kSpreadTile + width, x_end);
      const std::uint16_t* texels =
          texels_of_tile(view, of_y * view.tiles_x + of_x) +
          kSpreadTexelHalves *
              static_cast<std::size_t>((inside % kSpreadTile) * width + x % kSpreadTile);
      unpack(texels, end - x, row_at(memory, x - left + kMostSpreadStep, row), isa);
      x = end;
    }
    const int first = x_begin - left + kMostSpreadStep, last = x_end - left + kMostSpreadStep - 1;
    const int begin = kMostSpreadStep - reach, after = right - left + kMostSpreadStep + reach;
    if (first > begin) repeat_pixel(memory, first, begin, first - begin, row);
    if (last + 1 < after) repeat_pixel(memory, last, last + 1, after - last - 1, row);
  }
}

// The largest step of the levels of a tile.
int reach_of(const SpreadSteps& steps, ViewTiles::Levels levels) {
  // Nearer and farther from the focus steps only grow.
  return std::max(steps.reach_px[levels.nearest], steps.reach_px[levels.farthest]);
}

// The farthest that a ray may reach from a tile, or come from, by the tile and those around it.
int reach_around(const ViewTiles& view, const SpreadSteps& steps, int tile_x, int tile_y) {
  int reach = 0;
  for (int y = std::max(tile_y - 1, 0); y <= std::min(tile_y + 1, view.tiles_y - 1); ++y) {
    for (int x = std::max(tile_x - 1, 0); x <= std::min(tile_x + 1, view.tiles_x - 1); ++x) {
      const auto tile = static_cast<std::size_t>(y * view.tiles_x + x);
      reach = std::max(reach, reach_of(steps, view.levels[tile]));
    }
  }
  return reach;
}

// The source of the ray among a cell's pixels.
std::ptrdiff_t source_scalar(const CellWork& cell, const std::int32_t* offsets, std::ptrdiff_t at) {
  for (int i = 0; i < cell.sought_count; ++i) {
    const std::ptrdiff_t from = at + offsets[cell.sought[i]];
    if (cell.levels[from] == cell.sought[i]) return from;
  }
  const std::ptrdiff_t own = at + offsets[cell.levels[at]];
  return cell.levels[own] > cell.levels[at] ? own : at;
}

void spread_cell_scalar(const CellWork& cell) {
  const float share = 1.0f / static_cast<float>(cell.rays);
  for (int y = 0; y < cell.rows; ++y) {
    for (int x = 0; x < cell.width; ++x) {
      const std::ptrdiff_t at = y * std::ptrdiff_t{kSpreadStride} + x;
      float sum[3] = {};
      for (int ray = 0; ray < cell.rays; ++ray) {
        const std::ptrdiff_t from =
            source_scalar(cell, cell.offsets + std::ptrdiff_t{ray} * kSpreadLevels, at);
        for (int c = 0; c < 3; ++c) {
          const float colour = cell.colours[c * kSpreadPlane + from];
          sum[c] = ray == 0 ? colour : sum[c] + colour;
        }
      }
      float* to = cell.sums + y * std::ptrdiff_t{kSpreadTile} + x;
      for (int c = 0; c < 3; ++c) {
        const float mean = sum[c] * share;
        to[c * kSumPlane] = cell.begin ? mean : to[c * kSumPlane] + mean;
      }
    }
  }
}

// Without rays that move.
void add_cell_scalar(const CellWork& cell) {
  for (int c = 0; c < 3; ++c) {
    for (int y = 0; y < cell.rows; ++y) {
      const float* from = cell.colours + c * kSpreadPlane + y * std::ptrdiff_t{kSpreadStride};
      float* to = cell.sums + c * kSumPlane + y * std::ptrdiff_t{kSpreadTile};
      for (int x = 0; x < cell.width; ++x) to[x] = cell.begin ? from[x] : to[x] + from[x];
    }
  }
}

}  // namespace

SpreadMemory make_spread_memory() {
  // Lanes read and write whole vectors past the last pixel.
  SpreadMemory memory;
  memory.colours = make_row_memory<float>(3 * kSpreadPlane + kMostLanes);
  memory.levels = make_row_memory<std::int32_t>(kSpreadPlane + kMostLanes);
  memory.sums = make_row_memory<float>(3 * kSumPlane + kMostLanes);
  memory.runs = std::make_unique<RayRuns>();
  return memory;
}

void spread_tile(const ViewTiles& view, const SpreadSteps& steps, int tile, bool begin,
                 SpreadMemory& memory, Isa isa) {
  const int tile_x = tile % view.tiles_x, tile_y = tile / view.tiles_x;
  const int width = tile_width(view, tile_x), height = tile_height(view, tile_y);
  const int reach = reach_around(view, steps, tile_x, tile_y);
  unpack_around(view, tile_x, tile_y, reach, memory, isa);
  CellWork cell{.colours = nullptr,
                .levels = nullptr,
                .offsets = steps.offsets.data(),
                .sought = nullptr,
                .runs = memory.runs.get(),
                .sought_count = 0,
                .rays = steps.rays,
                .width = 0,
                .rows = 0,
                .begin = begin,
                .sums = nullptr};
  CellLevels levels;
  if (reach > 0) find_levels(memory.levels.get(), width, height, reach, isa, levels);
  NearLevels of_runs;
  for (int y = 0; y < height; y += kCellHeight) {
    for (int x = 0; x < width; x += kCellWidth) {
      const UnpackedRow first = row_at(memory, kMostSpreadStep + x, kMostSpreadStep + y);
      cell.colours = first.r;
      cell.levels = first.level;
      cell.width = std::min(kCellWidth, width - x);
      cell.rows = std::min(kCellHeight, height - y);
      cell.sums = memory.sums.get() + y * std::ptrdiff_t{kSpreadTile} + x;
      LevelList sought;
      int cell_reach = 0;
      if (reach > 0) {
        const NearLevels near = levels_near(levels, steps, x / kCellWidth + kFirstCellX,
                                            y / kCellHeight + kFirstCellY, reach);
        sought = list_of(near.reaching);
        const auto nearest = static_cast<std::size_t>(sought.number[0]);
        const auto farthest =
            static_cast<std::size_t>(sought.number[static_cast<std::size_t>(sought.count - 1)]);
        cell_reach = std::max(steps.reach_px[nearest], steps.reach_px[farthest]);
        if (cell_reach > 0 && isa != Isa::scalar && near != of_runs) {
          find_runs(steps, sought, near.reaching == near.all, *memory.runs);
          of_runs = near;
        }
      }
      cell.sought = sought.number.data();
      cell.sought_count = sought.count;
      if (isa == Isa::scalar) {
        cell_reach > 0 ? spread_cell_scalar(cell) : add_cell_scalar(cell);
      } else if (cell_reach > 0) {
        SOFTFOCUS_KERNEL(isa, spread_cell)(cell);
      } else {
        SOFTFOCUS_KERNEL(isa, add_cell)(cell);
      }
    }
  }
}

}  // namespace softfocus

#else  // kernels

void unpack_texels(const std::uint16_t* texels, int count, const UnpackedRow& to) {
  for (int i = 0; i < count; i += kLanes) {
    const HalfTexels loaded = load_half_texels(texels + 4 * i);
    store(to.r + i, half_to_float(loaded.r));
    store(to.g + i, half_to_float(loaded.g));
    store(to.b + i, half_to_float(loaded.b));
    store(to.level + i, as_ints(loaded.a));
  }
}

namespace {

struct Colours {
  Floats r, g, b;
};

SOFTFOCUS_INLINE Colours load_colours(const float* from) {
  return {load(from), load(from + kSpreadPlane), load(from + 2 * kSpreadPlane)};
}

// Colours of the lanes that are left, whose levels are nowhere.
SOFTFOCUS_INLINE Colours beside(const CellWork& cell, const std::int32_t* offsets, int at,
                                Mask left, const Colours& others) {
  const Ints own = load(cell.levels + at);
  const Ints places = lane_numbers() + at;
  const Ints moved = places + gather(offsets, own, left);
  const Ints level = gather(cell.levels, moved, left);
  const Ints from = select(level > own, moved, places);
  return {select(left, gather(cell.colours, from, left), others.r),
          select(left, gather(cell.colours + kSpreadPlane, from, left), others.g),
          select(left, gather(cell.colours + 2 * kSpreadPlane, from, left), others.b)};
}

SOFTFOCUS_INLINE void add(Colours& sum, const Colours& more) {
  sum = {sum.r + more.r, sum.g + more.g, sum.b + more.b};
}

// Colours that a ray sees from `count` pixels on. Few runs are cheaper without a branch between
// them.
template <int kRuns>
SOFTFOCUS_INLINE Colours seen_in_runs(const CellWork& cell, const LevelRun* runs,
                                      const std::int32_t* offsets, int at, int count) {
  Colours seen{};
  unsigned held_bits = 0;
  // The nearest comes last, over what lies behind it.
  for (int i = kRuns; i-- > 0;) {
    const int from = at + runs[i].offset;
    const Bits above = as_bits(load(cell.levels + from) - runs[i].first);
    const Bits span = splat(runs[i].span);
    const Colours of_run = load_colours(cell.colours + from);
    const Mask held = above <= span;
    seen = {select(held, of_run.r, seen.r), select(held, of_run.g, seen.g),
            select(held, of_run.b, seen.b)};
    held_bits |= at_most_lane_bits(above, span);
  }
  const unsigned wanted = count >= kLanes ? kAllLaneBits : (1u << count) - 1u;
  if ((held_bits & wanted) == wanted) [[likely]]
    return seen;
  Mask left = first_lanes(count);
  for (int i = 0; i < kRuns; ++i) {
    const Bits above = as_bits(load(cell.levels + at + runs[i].offset) - runs[i].first);
    left &= ~(above <= splat(runs[i].span));
  }
  return beside(cell, offsets, at, left, seen);
}

// seen_by_ray() for any number of runs.
SOFTFOCUS_INLINE Colours seen_by_ray(const CellWork& cell, const LevelRun* run, const LevelRun* end,
                                     const std::int32_t* offsets, int at, int count) {
  Mask left = first_lanes(count);
  unsigned left_bits = lane_bits(left);
  Colours seen{};
  for (; run < end; ++run) {
    const int from = at + run->offset;
    const Bits above = as_bits(load(cell.levels + from) - run->first);
    const Bits span = splat(run->span);
    const unsigned held_bits = at_most_lane_bits(above, span) & left_bits;
    if (held_bits == 0) continue;
    const Mask held = left & (above <= span);
    const Colours of_level = load_colours(cell.colours + from);
    if (held_bits == kAllLaneBits) return of_level;
    seen = {select(held, of_level.r, seen.r), select(held, of_level.g, seen.g),
            select(held, of_level.b, seen.b)};
    left &= ~held;
    left_bits &= ~held_bits;
    if (left_bits == 0) return seen;
  }
  return beside(cell, offsets, at, left, seen);
}

// Adds what a ray sees from a cell's rows on to their sums.
SOFTFOCUS_INLINE void add_ray(const CellWork& cell, int ray, int x, int count, Colours* sums) {
  const std::int32_t* offsets = cell.offsets + std::ptrdiff_t{ray} * kSpreadLevels;
  const auto number = static_cast<std::size_t>(ray);
  const LevelRun* runs = cell.runs->runs.data() + cell.runs->begin[number];
  const LevelRun* end = cell.runs->runs.data() + cell.runs->begin[number + 1];
  if (cell.runs->certain[number]) {
    const float* from = cell.colours + x + runs->offset;
    for (int y = 0; y < cell.rows; ++y) add(sums[y], load_colours(from + y * kSpreadStride));
    return;
  }
  // One branch for all rows, since what ends a search is hard to predict.
  const auto of_rows = [&](auto seen_from) {
    for (int y = 0; y < cell.rows; ++y) add(sums[y], seen_from(y * kSpreadStride + x));
  };
  switch (end - runs) {
    case 1: return of_rows([&](int at) { return seen_in_runs<1>(cell, runs, offsets, at, count); });
    case 2: return of_rows([&](int at) { return seen_in_runs<2>(cell, runs, offsets, at, count); });
    case 3: return of_rows([&](int at) { return seen_in_runs<3>(cell, runs, offsets, at, count); });
    case 4: return of_rows([&](int at) { return seen_in_runs<4>(cell, runs, offsets, at, count); });
    default:
      return of_rows([&](int at) { return seen_by_ray(cell, runs, end, offsets, at, count); });
  }
}

SOFTFOCUS_INLINE void add_to_sums(const CellWork& cell, int at, int count, const Colours& means) {
  const Mask there = first_lanes(count);
  const Floats channels[3] = {means.r, means.g, means.b};
  for (int c = 0; c < 3; ++c) {
    float* to = cell.sums + c * kSumPlane + at;
    const Floats sum = cell.begin ? channels[c] : load(to) + channels[c];
    // Lanes past the cell belong to the next one.
    store(to, count >= kLanes ? sum : select(there, sum, load(to)));
  }
}

}  // namespace

void spread_cell(const CellWork& cell) {
  const float share = 1.0f / static_cast<float>(cell.rays);
  // -0 + a is a, of either sign.
  const Floats none = splat(-0.0f);
  for (int x = 0; x < cell.width; x += kLanes) {
    const int count = cell.width - x;
    Colours sums[kCellHeight];
    for (int y = 0; y < cell.rows; ++y) sums[y] = {none, none, none};
    if (cell.runs->all_certain) {
      for (int y = 0; y < cell.rows; ++y) {
        const float* from = cell.colours + y * kSpreadStride + x;
        Colours sum = sums[y];
        for (int ray = 0; ray < cell.rays; ++ray) {
          add(sum, load_colours(from + cell.runs->runs[static_cast<std::size_t>(ray)].offset));
        }
        sums[y] = sum;
      }
    } else {
      for (int ray = 0; ray < cell.rays; ++ray) add_ray(cell, ray, x, count, sums);
    }
    for (int y = 0; y < cell.rows; ++y) {
      add_to_sums(cell, y * kSpreadTile + x, count,
                  {sums[y].r * share, sums[y].g * share, sums[y].b * share});
    }
  }
}

void add_cell(const CellWork& cell) {
  for (int y = 0; y < cell.rows; ++y) {
    for (int x = 0; x < cell.width; x += kLanes) {
      add_to_sums(cell, y * kSpreadTile + x, cell.width - x,
                  load_colours(cell.colours + y * kSpreadStride + x));
    }
  }
}

#endif

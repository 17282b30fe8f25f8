#ifndef SOFTFOCUS_ISA

#include "scenes/filtered_views/spread_tile.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstdlib>

#include "raster/images/texel.h"

namespace softfocus {
namespace {

constexpr std::size_t kSpreadTexelHalves = 4;
constexpr std::ptrdiff_t kPlane = std::ptrdiff_t{kSpreadRows} * kSpreadStride;
constexpr std::ptrdiff_t kSumPlane = std::ptrdiff_t{kSpreadTile} * kSpreadTile;

// Cells in which levels are counted, of the tile and of what lies around it.
constexpr int kCellWidth = 16, kCellHeight = 8;
constexpr int kCellsAcross = kSpreadRows / kCellWidth, kCellsDown = kSpreadRows / kCellHeight;
// Cells that rays reach beside a cell.
constexpr int kRingAcross = kMostSpreadStep / kCellWidth;
constexpr int kRingDown = kMostSpreadStep / kCellHeight;

// Levels are counted from 0 here, not from -L.
constexpr int kWords = LevelSet::kWords;

// A run of pixels of a row in lanes, or one by one.
struct UnpackedRow {
  float *r, *g, *b;
  std::int32_t* level;
};

// Levels to look for, from the nearest.
struct LevelList {
  std::array<std::int32_t, kSpreadLevels> number;
  int count = 0;
};

// A cell's rows and what its rays look at.
struct CellWork {
  const float* colours;        // of its first pixel
  const std::int32_t* levels;  // the same
  const std::int32_t* offsets;
  const std::int32_t* sought;
  int sought_count, rays;
  int width, rows;
  bool one_level;  // of all that its rays look at
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
  return {first, first + kPlane, first + 2 * kPlane, memory.levels.get() + at};
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

// Of a tile and those around it: what a ray may reach from the tile, or come from.
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

// A square of a tile's planes that may stick out of what is there.
LevelSet levels_of_cell(const SpreadMemory& memory, int x_begin, int y_begin, int x_end, int y_end,
                        Isa isa) {
  LevelSet set;
  if (isa != Isa::scalar && x_begin < x_end && y_begin < y_end &&
      SOFTFOCUS_KERNEL(isa, add_levels)(
          memory.levels.get() + y_begin * std::ptrdiff_t{kSpreadStride} + x_begin, x_end - x_begin,
          y_end - y_begin, set)) {
    return set;
  }
  for (int y = y_begin; y < y_end; ++y) {
    const std::int32_t* levels = memory.levels.get() + y * std::ptrdiff_t{kSpreadStride};
    for (int x = x_begin; x < x_end; ++x) {
      set.bits[levels[x] / 64] |= std::uint64_t{1} << levels[x] % 64;
    }
  }
  return set;
}

struct CellLevels {
  LevelSet of[kCellsDown][kCellsAcross];
};

void find_levels(const SpreadMemory& memory, int width, int height, int reach, Isa isa,
                 CellLevels& cells) {
  const int begin = kMostSpreadStep - reach;
  const int x_end = kMostSpreadStep + width + reach, y_end = kMostSpreadStep + height + reach;
  for (int cell_y = 0; cell_y < kCellsDown; ++cell_y) {
    for (int cell_x = 0; cell_x < kCellsAcross; ++cell_x) {
      cells.of[cell_y][cell_x] = levels_of_cell(memory, std::max(cell_x * kCellWidth, begin),
                                                std::max(cell_y * kCellHeight, begin),
                                                std::min((cell_x + 1) * kCellWidth, x_end),
                                                std::min((cell_y + 1) * kCellHeight, y_end), isa);
    }
  }
}

struct NearLevels {
  LevelSet reaching;  // that may come to a cell
  LevelSet all;       // that its rays may look at
};

NearLevels levels_near(const CellLevels& cells, const SpreadSteps& steps, int cell_x, int cell_y,
                       int reach) {
  NearLevels near{cells.of[cell_y][cell_x], cells.of[cell_y][cell_x]};
  const int across = (reach + kCellWidth - 1) / kCellWidth;
  const int down = (reach + kCellHeight - 1) / kCellHeight;
  for (int y = -down; y <= down; ++y) {
    for (int x = -across; x <= across; ++x) {
      if (x == 0 && y == 0) continue;
      // Pixels between the two cells.
      const int apart_x = std::max(std::abs(x) - 1, 0) * kCellWidth;
      const int apart_y = std::max(std::abs(y) - 1, 0) * kCellHeight;
      const LevelSet& from =
          steps.reaching[static_cast<std::size_t>(std::max(apart_x, apart_y) / kCellHeight)];
      for (int word = 0; word < kWords; ++word) {
        const std::uint64_t bits = cells.of[cell_y + y][cell_x + x].bits[word];
        near.reaching.bits[word] |= bits & from.bits[word];
        near.all.bits[word] |= bits;
      }
    }
  }
  return near;
}

int count_of(const LevelSet& levels) {
  int count = 0;
  for (const std::uint64_t word : levels.bits) count += std::popcount(word);
  return count;
}

LevelList list_of(const LevelSet& levels) {
  LevelList list;
  for (int word = 0; word < kWords; ++word) {
    for (std::uint64_t left = levels.bits[word]; left != 0; left &= left - 1) {
      list.number[static_cast<std::size_t>(list.count++)] = 64 * word + std::countr_zero(left);
    }
  }
  return list;
}

// Where the ray comes from, among a cell's pixels.
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
          const float colour = cell.colours[c * kPlane + from];
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
      const float* from = cell.colours + c * kPlane + y * std::ptrdiff_t{kSpreadStride};
      float* to = cell.sums + c * kSumPlane + y * std::ptrdiff_t{kSpreadTile};
      for (int x = 0; x < cell.width; ++x) to[x] = cell.begin ? from[x] : to[x] + from[x];
    }
  }
}

}  // namespace

SpreadSteps spread_steps(const ViewSpread& spread, std::span<const glm::dvec2> points,
                         glm::dvec2 in_pixel) {
  SpreadSteps steps{
      static_cast<int>(points.size()), ray_steps(spread, points, in_pixel), {}, {}, {}};
  steps.reach_px.resize(kSpreadLevels);
  for (std::size_t i = 0; i < steps.steps.size(); ++i) {
    const PixelStep step = steps.steps[i];
    steps.offsets.push_back(step.y * kSpreadStride + step.x);
    std::int16_t& reach = steps.reach_px[i % kSpreadLevels];
    const int longest = std::max({int{reach}, std::abs(step.x), std::abs(step.y)});
    assert(longest <= kMostSpreadStep);
    reach = static_cast<std::int16_t>(longest);
  }
  // Rounding may take a pixel from a level's step. The reach of all from the focus to it does not.
  for (std::size_t away = 1; away <= kMostSpreadLevel; ++away) {
    std::int16_t* focus = steps.reach_px.data() + kMostSpreadLevel;
    focus[away] = std::max(focus[away], focus[away - 1]);
    std::int16_t* before = focus - away;
    *before = std::max(*before, before[1]);
  }
  for (int away = 0; away <= kRingDown; ++away) {
    LevelSet& reaching = steps.reaching.emplace_back();
    for (int level = 0; level < kSpreadLevels; ++level) {
      if (steps.reach_px[static_cast<std::size_t>(level)] <= away * kCellHeight) continue;
      reaching.bits[level / 64] |= std::uint64_t{1} << level % 64;
    }
  }
  return steps;
}

SpreadMemory make_spread_memory() {
  // Lanes read and write whole vectors past the last pixel.
  SpreadMemory memory;
  memory.colours = make_row_memory<float>(3 * kPlane + kMostLanes);
  memory.levels = make_row_memory<std::int32_t>(kPlane + kMostLanes);
  memory.sums = make_row_memory<float>(3 * kSumPlane + kMostLanes);
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
                .sought_count = 0,
                .rays = steps.rays,
                .width = 0,
                .rows = 0,
                .one_level = false,
                .begin = begin,
                .sums = nullptr};
  CellLevels levels;
  if (reach > 0) find_levels(memory, width, height, reach, isa, levels);
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
        const NearLevels near = levels_near(levels, steps, x / kCellWidth + kRingAcross,
                                            y / kCellHeight + kRingDown, reach);
        sought = list_of(near.reaching);
        cell.one_level = count_of(near.all) == 1;
        const auto nearest = static_cast<std::size_t>(sought.number[0]);
        const auto farthest =
            static_cast<std::size_t>(sought.number[static_cast<std::size_t>(sought.count - 1)]);
        cell_reach = std::max(steps.reach_px[nearest], steps.reach_px[farthest]);
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

/// The levels of a square, if they are within 32 of each other.
bool add_levels(const std::int32_t* levels, int width, int rows, LevelSet& set) {
  Ints least = splat(kSpreadLevels), most = splat(0);
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < width; x += kLanes) {
      const Ints level = load(levels + y * kSpreadStride + x);
      const Mask there = first_lanes(width - x);
      least = smaller(least, select(there, level, least));
      most = larger(most, select(there, level, most));
    }
  }
  std::int32_t first = least[0], last = most[0];
  for (int i = 1; i < kLanes; ++i) {
    first = least[i] < first ? least[i] : first;
    last = most[i] > last ? most[i] : last;
  }
  if (last - first >= 32) return false;
  Bits seen = splat(0u);
  if (last - first < 2) {
    seen |= 1u | 1u << (last - first);
  } else {
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < width; x += kLanes) {
        const Bits above = as_bits(load(levels + y * kSpreadStride + x) - first);
        seen |= select(first_lanes(width - x), splat(1u) << (above & 31u), splat(0u));
      }
    }
  }
  std::uint32_t bits = 0;
  for (int i = 0; i < kLanes; ++i) bits |= seen[i];
  const int word = first / 64, place = first % 64;
  set.bits[word] |= std::uint64_t{bits} << place;
  if (place > 32 && word + 1 < kWords) set.bits[word + 1] |= std::uint64_t{bits} >> (64 - place);
  return true;
}

namespace {

struct Colours {
  Floats r, g, b;
};

SOFTFOCUS_INLINE Colours load_colours(const float* from) {
  return {load(from), load(from + kPlane), load(from + 2 * kPlane)};
}

// What the lanes that are left see, whose levels are nowhere.
SOFTFOCUS_INLINE Colours beside(const CellWork& cell, const std::int32_t* offsets, int at,
                                Mask left, const Colours& others) {
  const Ints own = load(cell.levels + at);
  const Ints places = lane_numbers() + at;
  const Ints moved = places + gather(offsets, own, left);
  const Ints level = gather(cell.levels, moved, left);
  const Ints from = select(level > own, moved, places);
  return {select(left, gather(cell.colours, from, left), others.r),
          select(left, gather(cell.colours + kPlane, from, left), others.g),
          select(left, gather(cell.colours + 2 * kPlane, from, left), others.b)};
}

// The colours that a ray sees from `count` pixels on.
SOFTFOCUS_INLINE Colours seen_by_ray(const CellWork& cell, const std::int32_t* offsets, int at,
                                     int count) {
  if (cell.one_level) return load_colours(cell.colours + at + offsets[cell.sought[0]]);
  Mask left = first_lanes(count);
  unsigned left_bits = lane_bits(left);
  Colours seen{};
  for (int i = 0; i < cell.sought_count; ++i) {
    const std::int32_t level = cell.sought[i];
    const int from = at + offsets[level];
    const Ints found = load(cell.levels + from);
    const unsigned held_bits = equal_lane_bits(found, splat(level)) & left_bits;
    if (held_bits == 0) continue;
    const Mask held = left & (found == level);
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
  for (int y = 0; y < cell.rows; ++y) {
    for (int x = 0; x < cell.width; x += kLanes) {
      const int count = cell.width - x;
      const int at = y * kSpreadStride + x;
      Colours sum = seen_by_ray(cell, cell.offsets, at, count);
      for (int ray = 1; ray < cell.rays; ++ray) {
        const Colours seen =
            seen_by_ray(cell, cell.offsets + std::ptrdiff_t{ray} * kSpreadLevels, at, count);
        sum = {sum.r + seen.r, sum.g + seen.g, sum.b + seen.b};
      }
      add_to_sums(cell, y * kSpreadTile + x, count, {sum.r * share, sum.g * share, sum.b * share});
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

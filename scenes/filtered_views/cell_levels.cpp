#ifndef SOFTFOCUS_ISA

#include "scenes/filtered_views/cell_levels.h"

#include <algorithm>
#include <cstdlib>

#define SOFTFOCUS_KERNELS "scenes/filtered_views/cell_levels.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

// A square of a tile's planes that may stick out of what is there.
LevelSet levels_of_cell(const std::int32_t* levels, int x_begin, int y_begin, int x_end, int y_end,
                        Isa isa) {
  LevelSet set;
  if (isa != Isa::scalar && x_begin < x_end && y_begin < y_end &&
      SOFTFOCUS_KERNEL(isa, add_levels)(levels + y_begin * std::ptrdiff_t{kSpreadStride} + x_begin,
                                        x_end - x_begin, y_end - y_begin, set)) {
    return set;
  }
  for (int y = y_begin; y < y_end; ++y) {
    const std::int32_t* row = levels + y * std::ptrdiff_t{kSpreadStride};
    for (int x = x_begin; x < x_end; ++x) {
      set.bits[row[x] / 64] |= std::uint64_t{1} << row[x] % 64;
    }
  }
  return set;
}

}  // namespace

void find_levels(const std::int32_t* levels, int width, int height, int reach, Isa isa,
                 CellLevels& cells) {
  const int begin = kMostSpreadStep - reach;
  const int x_end = kMostSpreadStep + width + reach, y_end = kMostSpreadStep + height + reach;
  for (int cell_y = 0; cell_y < kCellsDown; ++cell_y) {
    for (int cell_x = 0; cell_x < kCellsAcross; ++cell_x) {
      cells.of[cell_y][cell_x] = levels_of_cell(levels, std::max(cell_x * kCellWidth, begin),
                                                std::max(cell_y * kCellHeight, begin),
                                                std::min((cell_x + 1) * kCellWidth, x_end),
                                                std::min((cell_y + 1) * kCellHeight, y_end), isa);
    }
  }
}

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
          steps.reaching[static_cast<std::size_t>(std::max(apart_x, apart_y) / kReachStepPx)];
      for (int word = 0; word < LevelSet::kWords; ++word) {
        const std::uint64_t bits = cells.of[cell_y + y][cell_x + x].bits[word];
        near.reaching.bits[word] |= bits & from.bits[word];
        near.all.bits[word] |= bits;
      }
    }
  }
  return near;
}

}  // namespace softfocus

#else  // kernels

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
  if (place > 32 && word + 1 < LevelSet::kWords)
    set.bits[word + 1] |= std::uint64_t{bits} >> (64 - place);
  return true;
}

#endif

#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "dof/disc_layers/lit_discs.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#define SOFTFOCUS_KERNELS "dof/disc_layers/lit_discs.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

std::int64_t units_of(double light) { return static_cast<std::int64_t>(std::nearbyint(light)); }

}  // namespace

bool lit_near(const LitRung& rung, std::size_t level, int x, int y, int width, int height) {
  // A disc reaches 8 pixels of the rung's level, and each enlarging from it less than one more.
  constexpr int kReach = 2 * kDiscBlock;
  const auto block = [&](int at, int apron, int blocks) {
    const int in_level = (std::max(at, 0) >> (rung.level - level)) + apron;
    return std::clamp(in_level / kDiscBlock, 0, blocks - 1);
  };
  const int left = block(x, -kReach, rung.block_columns);
  const int right = block(x + width - 1, kReach, rung.block_columns);
  const int top = block(y, -kReach, rung.block_rows);
  const int bottom = block(y + height - 1, kReach, rung.block_rows);
  for (int row = top; row <= bottom; ++row) {
    for (int column = left; column <= right; ++column) {
      if (rung.blocks[static_cast<std::size_t>(row * rung.block_columns + column)] != 0)
        return true;
    }
  }
  return false;
}

LitGains make_gains(const DiscHighlights& highlights, const std::vector<DiscLevel>& levels,
                    MemoryShelf& shelf) {
  LitGains gains;
  // Counts floats first, then takes them.
  for (const bool count : {true, false}) {
    std::size_t used = 0;
    gains.planes.clear();
    for (const LitRung& rung : highlights.rungs) {
      std::vector<LevelPlanes>& planes = gains.planes.emplace_back();
      for (std::size_t i = 1; i <= rung.level; ++i) {
        planes.push_back(
            take_planes(1, levels[i].width, levels[i].height, gains.memory.get(), used));
      }
    }
    if (count) gains.memory = make_row_memory<float>(used, &shelf);
  }
  return gains;
}

void add_highlights(const DiscHighlights& highlights, const LitRung& rung, int x, int y, int width,
                    int height, const float (*gain)[kLevelTileWidth], LitSums& sums, LitTile& tile,
                    Isa isa) {
  const int rows = static_cast<int>(rung.parts_above.size()) - 1;
  const auto first =
      rung.parts_above[static_cast<std::size_t>(std::clamp(y - rung.reach, 0, rows))];
  const auto end =
      rung.parts_above[static_cast<std::size_t>(std::clamp(y + height + rung.reach, 0, rows))];
  bool any = false;
  for (std::size_t i = first; i < end; ++i) {
    const LitPart& part = rung.parts[i];
    if (part.x + rung.reach < x || part.x - rung.reach >= x + width) continue;
    if (!any) std::memset(&sums, 0, sizeof sums);
    any = true;
    const ExactDisc& disc = highlights.discs[part.disc];
    const int reach = static_cast<int>(disc.rows.size()) - 1;
    for (int dy = std::max(-reach, y - part.y); dy <= std::min(reach, y + height - 1 - part.y);
         ++dy) {
      const ExactDisc::Row& row = disc.rows[static_cast<std::size_t>(std::abs(dy))];
      SOFTFOCUS_KERNEL(isa, add_disc_row)
      (part.units, row.whole, row.outer, disc.covers.data() + row.cover, part.x - x, width,
       sums.differences[part.y + dy - y][0]);
    }
  }
  if (any) SOFTFOCUS_KERNEL(isa, add_lit_sums)(sums, width, height, gain, tile);
}

void light_at(const DiscHighlights& highlights, const LitRung& rung, int x, int y, float* light) {
  std::int64_t sums[3] = {0, 0, 0};
  for (const LitPart& part : rung.parts) {
    const ExactDisc& disc = highlights.discs[part.disc];
    const auto dx = std::abs(x - part.x), dy = std::abs(y - part.y);
    if (dy >= static_cast<int>(disc.rows.size())) continue;
    const ExactDisc::Row& row = disc.rows[static_cast<std::size_t>(dy)];
    if (dx > row.outer) continue;
    const double cover =
        dx <= row.whole ? 1.0
                        : disc.covers[row.cover + static_cast<std::size_t>(dx - row.whole - 1)];
    for (std::size_t i = 0; i < 3; ++i) sums[i] += units_of(part.units[i] * cover);
  }
  for (std::size_t i = 0; i < 3; ++i)
    light[i] = static_cast<float>(static_cast<double>(sums[i]) * kLightUnit);
}

}  // namespace softfocus

#else  // kernels

namespace {

using FourDoubles [[gnu::vector_size(32)]] = double;
using FourSums [[gnu::vector_size(32)]] = std::uint64_t;
using FourSigned [[gnu::vector_size(32)]] = std::int64_t;

// A number below 2^51 plus this has the rounded number in its low bits.
inline constexpr double kRoundingPlace = 0x1.8p52;

SOFTFOCUS_INLINE void to_units(const FourDoubles& light, FourSums& units) {
  const FourDoubles none = {};
  units = (FourSums)(light + kRoundingPlace) - (FourSums)(none + kRoundingPlace);
}

SOFTFOCUS_INLINE void add_sums(std::uint64_t* at, const FourSums& change) {
  FourSums sums;
  std::memcpy(&sums, at, sizeof sums);
  sums += change;
  std::memcpy(at, &sums, sizeof sums);
}

}  // namespace

/// Adds a row of a disc about `middle` to a row of differences, `width` pixels and one more.
void add_disc_row(const double* units, int whole, int outer, const double* covers, int middle,
                  int width, std::uint64_t* differences) {
  FourDoubles light;
  std::memcpy(&light, units, sizeof light);
  int x = middle - outer < 0 ? 0 : middle - outer;
  const int end = middle + outer < width - 1 ? middle + outer : width - 1;
  if (x > end) return;
  FourSums before = {};
  while (x <= end) {
    const int dx = x < middle ? middle - x : x - middle;
    FourSums here;
    to_units(dx <= whole ? light : light * covers[dx - whole - 1], here);
    add_sums(differences + 4 * x, here - before);
    before = here;
    x = dx <= whole ? middle + whole + 1 : x + 1;
  }
  // After the whole run x may lie beyond the end.
  const FourSums none = {};
  add_sums(differences + 4 * (end + 1), none - before);
}

/// Turns differences into light, and adds it times `gain`.
void add_lit_sums(const LitSums& sums, int width, int height, const float (*gain)[kLevelTileWidth],
                  LitTile& tile) {
  for (int y = 0; y < height; ++y) {
    FourSums sum = {};
    for (int x = 0; x < width; ++x) {
      FourSums change;
      std::memcpy(&change, sums.differences[y][x], sizeof change);
      sum += change;
      const FourDoubles light = __builtin_convertvector((FourSigned)sum, FourDoubles) * kLightUnit;
      for (int i = 0; i < 3; ++i) {
        tile.light[i][y][x] += gain[y][x] * static_cast<float>(light[i]);
      }
    }
  }
}

#endif

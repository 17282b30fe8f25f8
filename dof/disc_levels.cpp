#include "dof/disc_levels.h"

#include <algorithm>
#include <array>
#include <cmath>

#define SOFTFOCUS_KERNELS "dof/disc_levels_kernels.inl"
#include "raster/numbers/for_each_isa.inl"

namespace softfocus {
namespace {

// Pixels of a level that become one task's share of the next.
constexpr int kTaskWidth = 256;
constexpr int kTaskHeight = 16;
static_assert(kTaskHeight == 2 * kDiscBlock);

constexpr std::array<float, kTaskWidth> kOnes = [] {
  std::array<float, kTaskWidth> ones{};
  for (float& one : ones) one = 1.0f;
  return ones;
}();

DiscLevel make_level(int width, int height) {
  DiscLevel level{};
  level.width = width;
  level.height = height;
  level.block_columns = (width + kDiscBlock - 1) / kDiscBlock;
  level.block_rows = (height + kDiscBlock - 1) / kDiscBlock;
  const auto blocks = static_cast<std::size_t>(level.block_columns * level.block_rows);
  for (std::vector<std::uint32_t>& rungs : level.rungs) rungs.assign(blocks, 0);
  return level;
}

// The rungs of pixels in a row of blocks, gathered row by row.
struct Marks {
  std::array<std::uint32_t, kTaskWidth> rungs[2]{};

  // Into the level's blocks from x on, and away.
  void keep(DiscLevel& level, int x, int y, int count) {
    for (int side = 0; side < 2; ++side) {
      for (int i = 0; i < count; i += kDiscBlock) {
        std::uint32_t any = 0;
        for (int j = i; j < std::min(i + kDiscBlock, count); ++j) {
          any |= rungs[side][static_cast<std::size_t>(j)];
        }
        level.rungs[side][static_cast<std::size_t>(y / kDiscBlock * level.block_columns +
                                                   (x + i) / kDiscBlock)] = any;
      }
      rungs[side].fill(0);
    }
  }
};

void repeat_ends(const DiscLevel& level, int x, int count, float* row, std::ptrdiff_t stride) {
  if (x == 0) std::fill_n(row, kDiscMargin, row[kDiscMargin]);
  if (x + count == level.width) {
    std::fill(row + kDiscMargin + level.width, row + stride, row[kDiscMargin + level.width - 1]);
  }
}

// Rows below the picture repeat its last.
const std::uint16_t* texel_row(const DofInput& input, int y) {
  return row<std::uint16_t>(input.scene, std::min(y, input.scene.height - 1)).data();
}

struct Halving {
  const DofInput& input;
  DiscLevel& from;
  DiscLevel& to;
  bool whole;  // from the picture itself
  RungStep beyond;
  float least_square;
  int first_rung, next_first_rung;
};

// Of the picture at x, kTaskHeight rows from y on: marks, and the next level.
void halve_task(const Halving& halving, int from_x, int from_y, Isa isa) {
  DiscLevel& from = halving.from;
  DiscLevel& to = halving.to;
  const int width = std::min(kTaskWidth, from.width - from_x);
  const int x = from_x / 2, count = std::min(kTaskWidth / 2, to.width - x);
  float split[2][4][kTaskWidth];
  Marks marks, next_marks;
  for (int y = from_y; y < std::min(from_y + kTaskHeight, 2 * to.height); y += 2) {
    DiscRow rows[2][2];  // of sides
    bool larger[2] = {!halving.whole, !halving.whole};
    for (int i = 0; i < 2; ++i) {
      if (!halving.whole) {
        for (int side = 0; side < 2; ++side) rows[side][i] = disc_row(from, side, from_x, y + i);
        continue;
      }
      float(*const row)[kTaskWidth] = split[i];
      rows[0][i] = rows[1][i] = {{row[0], row[1], row[2], kOnes.data(), row[3]}};
      SOFTFOCUS_KERNEL(isa, split_disc_squares)
      (halving.input.settings, texel_row(halving.input, y + i), from_x, from.width, kTaskWidth,
       row[3]);
      const MarkedRungs marked =
          SOFTFOCUS_KERNEL(isa, mark_rungs)(row[3], kOnes.data(), width, halving.first_rung,
                                            marks.rungs[0].data(), marks.rungs[1].data());
      larger[0] = larger[0] || marked.near >> kFineRungs != 0;
      larger[1] = larger[1] || marked.far >> kFineRungs != 0;
    }
    if (halving.whole && (larger[0] || larger[1])) {
      for (int i = 0; i < 2; ++i) {
        SOFTFOCUS_KERNEL(isa, split_disc_colours)
        (texel_row(halving.input, y + i), from_x, from.width, kTaskWidth, split[i][0], kTaskWidth);
      }
    }
    for (int side = 0; side < 2; ++side) {
      Planes& planes = to.sides[side];
      float* row = plane_row(planes, 0, y / 2) + kDiscMargin + x;
      if (larger[side]) {
        const DiscHalving halves{{rows[side][0], rows[side][1]},
                                 halving.whole && side == 0 ? -1.0f : 1.0f,
                                 halving.beyond,
                                 halving.least_square,
                                 count,
                                 row,
                                 planes.plane};
        SOFTFOCUS_KERNEL(isa, halve_disc_rows)(halves);
        SOFTFOCUS_KERNEL(isa, mark_rungs)
        (row + kDiscSquare * planes.plane, row + kDiscWeight * planes.plane, count,
         halving.next_first_rung, next_marks.rungs[side].data(), next_marks.rungs[side].data());
      } else {
        for (int i = 0; i < kDiscChannels; ++i) std::fill_n(row + i * planes.plane, count, 0.0f);
      }
      for (int i = 0; i < kDiscChannels; ++i) {
        repeat_ends(to, x, count, plane_row(planes, i, y / 2), planes.stride);
      }
    }
    if (halving.whole && (y + 2) % kDiscBlock == 0) marks.keep(from, from_x, y, width);
  }
  if (halving.whole) {
    const int last = std::min(from_y + kTaskHeight, from.height) - 1;
    if ((2 * to.height) % kDiscBlock != 0 && last == from.height - 1) {
      marks.keep(from, from_x, last, width);
    }
  }
  next_marks.keep(to, x, from_y / 2, count);
}

}  // namespace

void split_disc_row(const DofInput& input, int x, int y, int count, float* to,
                    std::ptrdiff_t channel, Isa isa) {
  const std::uint16_t* from = texel_row(input, y);
  SOFTFOCUS_KERNEL(isa, split_disc_colours)(from, x, input.scene.width, count, to, channel);
  SOFTFOCUS_KERNEL(isa, split_disc_squares)
  (input.settings, from, x, input.scene.width, count, to + 3 * channel);
}

Planes make_disc_planes(int count, const DiscLevel& level) {
  return make_planes(count, level.width + 2 * kDiscMargin + kDiscTileWidth, level.height);
}

DiscRow disc_row(const DiscLevel& level, int side, int x, int y) {
  const Planes& planes = level.sides[side];
  const float* at = plane_row(planes, 0, std::clamp(y, 0, level.height - 1)) + kDiscMargin + x;
  DiscRow row;
  for (int i = 0; i < kDiscChannels; ++i) row.channel[i] = at + i * planes.plane;
  return row;
}

std::vector<DiscLevel> make_disc_levels(const DofInput& input,
                                        const std::vector<LevelRungs>& ladder, ThreadPool& pool) {
  std::vector<DiscLevel> levels;
  levels.push_back(make_level(input.scene.width, input.scene.height));
  int first_rung = 0, next_first_rung = kFineRungs;
  for (std::size_t i = 1; i <= ladder.size(); ++i) {
    DiscLevel& from = levels.back();
    DiscLevel to = make_level((from.width + 1) / 2, (from.height + 1) / 2);
    for (Planes& planes : to.sides) planes = make_disc_planes(kDiscChannels, to);
    const bool last = i == ladder.size();
    if (last && i > 1) break;
    const Halving halving{input,
                          from,
                          to,
                          i == 1,
                          ladder[i - 1].beyond,
                          last ? 0.0f : ladder[i].rungs[0].square,
                          first_rung,
                          next_first_rung};
    const int columns = (from.width + kTaskWidth - 1) / kTaskWidth;
    const int rows = (from.height + kTaskHeight - 1) / kTaskHeight;
    pool.for_each(columns * rows, [&](int task) {
      halve_task(halving, task % columns * kTaskWidth, task / columns * kTaskHeight, pool.isa());
    });
    if (last) break;
    levels.push_back(std::move(to));
    first_rung = next_first_rung;
    next_first_rung += kLevelRungs;
  }
  return levels;
}

std::uint32_t rungs_near(const DiscLevel& level, int side, int x, int y, int width, int height) {
  const int left = std::clamp((x - kDiscApron) / kDiscBlock, 0, level.block_columns - 1);
  const int right =
      std::clamp((x + width - 1 + kDiscApron) / kDiscBlock, 0, level.block_columns - 1);
  const int top = std::clamp((y - kDiscApron) / kDiscBlock, 0, level.block_rows - 1);
  const int bottom =
      std::clamp((y + height - 1 + kDiscApron) / kDiscBlock, 0, level.block_rows - 1);
  std::uint32_t rungs = 0;
  for (int row = top; row <= bottom; ++row) {
    for (int column = left; column <= right; ++column) {
      rungs |= level.rungs[side][static_cast<std::size_t>(row * level.block_columns + column)];
    }
  }
  return rungs;
}

}  // namespace softfocus

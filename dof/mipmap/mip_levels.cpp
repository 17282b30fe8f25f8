#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "dof/mipmap/mip_levels.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "dof/disc_layers/disc_levels.h"
#include "dof/picture_planes.h"
#include "raster/threads/loops.h"

namespace softfocus {

// Two rows of a side, to become one of the next level.
struct MipHalving {
  LevelRow rows[2];
  RungStep beyond;
  float least_square;  // of the next level
  int count;           // pixels of the result
  float* to;           // its channels, `plane` floats apart
  std::ptrdiff_t plane;
};

// The rungs of a level, and what lies beyond.
struct MipSteps {
  RungStep steps[kFineMipRungs + 1];
  int rungs;
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "dof/mipmap/mip_levels.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

// Pixels of level 0 that are read at once while levels are made.
constexpr int kPiece = kLevelTileWidth;

MipLevel make_level(int width, int height) {
  MipLevel level;
  level.width = width;
  level.height = height;
  level.block_columns = (width + kMipBlockWidth - 1) / kMipBlockWidth;
  level.block_rows = (height + kMipBlockHeight - 1) / kMipBlockHeight;
  for (std::vector<std::uint8_t>& marks : level.marks) {
    marks.assign(static_cast<std::size_t>(level.block_columns * level.block_rows), 0);
  }
  return level;
}

// Whole vectors begin anywhere in the right margin.
constexpr RowRoom kMipRoom{kMipMargin, kMipMargin + kMostLanes};

MipSteps steps_of(const MipLevelRungs& level) {
  MipSteps steps{};
  for (const MipRung& rung : level.rungs) steps.steps[steps.rungs++] = rung.step;
  steps.steps[steps.rungs] = level.beyond;
  return steps;
}

std::uint8_t* marks_of(MipLevel& level, MipSide side, int x, int y) {
  const int block = y / kMipBlockHeight * level.block_columns + x / kMipBlockWidth;
  return level.marks[static_cast<int>(side)].data() + block;
}

// Pixels of level 0 in whole blocks.
int blocks_width(const MipLevel& level, int x) {
  return std::min(kPiece, level.block_columns * kMipBlockWidth - x);
}

struct Making {
  const DofInput& input;
  const std::vector<MipLevelRungs>& ladder;
  MipPyramid& pyramid;
  ThreadPool& pool;
};

// Rows of a block are a task.
template <class Body>
void for_each_row(const MipLevel& level, ThreadPool& pool, const Body& body) {
  for_each_row(pool, level.height, kMipBlockHeight, body);
}

MipHalving halving_to(const Making& making, int level, MipSide side, int x, int y) {
  const auto number = static_cast<std::size_t>(level);
  const MipLevel& to = making.pyramid.levels[number];
  const LevelPlanes& planes = to.sides[static_cast<int>(side)];
  MipHalving halving{};
  halving.beyond = making.ladder[number - 1].beyond;
  halving.least_square = making.ladder[number].rungs[0].square;
  halving.count = std::min(kPiece / 2, to.width - x);
  halving.to = plane_row(planes, 0, y) + x;
  halving.plane = planes.plane;
  return halving;
}

// From the picture: the marks of what lies before the focus, its level 1, and level 1 of the
// picture without it.
void start_near(const Making& making) {
  MipLevel& whole = making.pyramid.levels[0];
  MipLevel& half = making.pyramid.levels[1];
  const MipSteps steps = steps_of(making.ladder[0]);
  const bool deeper = making.ladder.size() > 1;
  std::atomic<bool> any{false};
  for_each_row(half, making.pool, [&](int y) {
    for (int x = 0; x < whole.width; x += kPiece) {
      MipPictureRow rows[2];
      unsigned marked = 0;
      for (int i = 0; i < 2; ++i) {
        const int row = std::min(2 * y + i, whole.height - 1);
        split_disc_row(making.input, x, row, kPiece, rows[i].near[0], kMipTileRow,
                       making.pool.isa());
        marked |= SOFTFOCUS_KERNEL(making.pool.isa(), mark_mip_row)(
            rows[i].near[3], nullptr, -1.0f, blocks_width(whole, x), steps,
            marks_of(whole, MipSide::near, x, row));
      }
      if ((marked & ~1u) != 0) any.store(true, std::memory_order_relaxed);
      SOFTFOCUS_KERNEL(making.pool.isa(), halve_holed_picture)
      (rows[0].near[0], rows[1].near[0], kMipTileRow, steps.steps[1],
       std::min(kPiece / 2, half.width - x / 2), plane_row(half.filled, 0, y) + x / 2,
       half.filled.plane);
      if (!deeper) continue;
      MipHalving halving = halving_to(making, 1, MipSide::near, x / 2, y);
      for (int i = 0; i < 2; ++i) {
        for (int c = 0; c < 3; ++c) halving.rows[i].channel[c] = rows[i].near[c];
        halving.rows[i].channel[kLevelSquare] = rows[i].near[3];
      }
      SOFTFOCUS_KERNEL(making.pool.isa(), halve_mip_rows)(halving, -1.0f);
    }
    if (deeper) repeat_ends(half.sides[0], kLevelChannels, half.width, y);
    repeat_ends(half.filled, kHoledChannels, half.width, y);
  });
  making.pyramid.any_near = any.load();
}

// Fills the holes level by level, from the last.
void fill_holes(const Making& making) {
  std::vector<MipLevel>& levels = making.pyramid.levels;
  for (std::size_t i = 2; i < levels.size(); ++i) {
    const MipLevel& from = levels[i - 1];
    for_each_row(levels[i], making.pool, [&](int y) {
      const int next = std::min(2 * y + 1, from.height - 1);
      SOFTFOCUS_KERNEL(making.pool.isa(), halve_holed_rows)
      (plane_row(from.filled, 0, 2 * y), plane_row(from.filled, 0, next), from.filled.plane,
       levels[i].width, plane_row(levels[i].filled, 0, y), levels[i].filled.plane);
      repeat_ends(levels[i].filled, kHoledChannels, levels[i].width, y);
    });
  }
  for (std::size_t i = levels.size(); i-- > 1;) {
    const bool last = i + 1 == levels.size();
    for_each_row(levels[i], making.pool, [&](int y) {
      const float* rows[2] = {nullptr, nullptr};
      if (!last) {
        const int other =
            std::clamp(y % 2 == 0 ? y / 2 - 1 : y / 2 + 1, 0, levels[i + 1].height - 1);
        rows[0] = plane_row(levels[i + 1].filled, 0, y / 2);
        rows[1] = plane_row(levels[i + 1].filled, 0, other);
      }
      SOFTFOCUS_KERNEL(making.pool.isa(), fill_mip_row)
      (rows[0], rows[1], last ? 0 : levels[i + 1].filled.plane, levels[i].width,
       plane_row(levels[i].filled, 0, y), levels[i].filled.plane);
      repeat_ends(levels[i].filled, kFilledChannels, levels[i].width, y);
    });
  }
}

// From the picture: the marks of what lies behind, and its level 1.
void start_far(const Making& making) {
  MipLevel& whole = making.pyramid.levels[0];
  MipLevel& half = making.pyramid.levels[1];
  const MipSteps steps = steps_of(making.ladder[0]);
  const bool deeper = making.ladder.size() > 1;
  for_each_row(half, making.pool, [&](int y) {
    for (int x = 0; x < whole.width; x += kPiece) {
      MipPictureRow rows[2];
      for (int i = 0; i < 2; ++i) {
        const int row = std::min(2 * y + i, whole.height - 1);
        const bool fill = making.pyramid.any_near &&
                          (rungs_near(whole, MipSide::near, x, row, kPiece, 1) & ~1u) != 0;
        read_mip_row(making.input, making.pyramid, steps.steps[1], x, row, kPiece, fill, rows[i],
                     making.pool.isa());
        SOFTFOCUS_KERNEL(making.pool.isa(), mark_mip_row)
        (rows[i].far[3], nullptr, 1.0f, blocks_width(whole, x), steps,
         marks_of(whole, MipSide::far, x, row));
      }
      if (!deeper) continue;
      MipHalving halving = halving_to(making, 1, MipSide::far, x / 2, y);
      for (int i = 0; i < 2; ++i) {
        for (int c = 0; c < 3; ++c) halving.rows[i].channel[c] = rows[i].far[c];
        halving.rows[i].channel[kLevelSquare] = rows[i].far[3];
      }
      SOFTFOCUS_KERNEL(making.pool.isa(), halve_mip_rows)(halving, 1.0f);
    }
    if (deeper) repeat_ends(half.sides[1], kLevelChannels, half.width, y);
  });
}

void mark_level(const Making& making, std::size_t number, MipSide side, int y) {
  MipLevel& level = making.pyramid.levels[number];
  const LevelPlanes& planes = level.sides[static_cast<int>(side)];
  SOFTFOCUS_KERNEL(making.pool.isa(), mark_mip_row)
  (plane_row(planes, kLevelSquare, y), plane_row(planes, kLevelWeight, y), 1.0f,
   level.block_columns * kMipBlockWidth, steps_of(making.ladder[number]),
   marks_of(level, side, 0, y));
}

void make_side(const Making& making, MipSide side) {
  std::vector<MipLevel>& levels = making.pyramid.levels;
  const int number = static_cast<int>(side);
  for (std::size_t i = 1; i < making.ladder.size(); ++i) {
    const MipLevel& from = levels[i - 1];
    for_each_row(levels[i], making.pool, [&](int y) {
      if (i > 1) {
        MipHalving halving = halving_to(making, static_cast<int>(i), side, 0, y);
        halving.count = levels[i].width;
        for (int row = 0; row < 2; ++row) {
          for (int c = 0; c < kLevelChannels; ++c) {
            halving.rows[row].channel[c] =
                plane_row(from.sides[number], c, std::min(2 * y + row, from.height - 1));
          }
        }
        SOFTFOCUS_KERNEL(making.pool.isa(), halve_mip_rows)(halving, 1.0f);
        repeat_ends(levels[i].sides[number], kLevelChannels, levels[i].width, y);
      }
      mark_level(making, i, side, y);
    });
  }
}

// Gives each level but the first its planes, or counts their floats.
void share_memory(const Making& making, float* const (&memory)[2], std::size_t (&used)[2]) {
  std::vector<MipLevel>& levels = making.pyramid.levels;
  for (std::size_t i = 1; i < levels.size(); ++i) {
    MipLevel& level = levels[i];
    const auto take = [&](int channels, int piece, RowRoom room) {
      const auto number = static_cast<std::size_t>(piece);
      return take_planes(channels, level.width, level.height, memory[number], used[number], room);
    };
    level.filled = take(kHoledChannels, 0, kMipRoom);
    if (i >= making.ladder.size()) continue;
    for (int side = 0; side < 2; ++side) {
      level.seen[side] = take(kSeenChannels, 0, kSeenRoom);
      level.sides[side] = take(kLevelChannels, 1, kMipRoom);
    }
  }
}

// Enough levels for the ladder and, for what is to be filled, down to one pixel.
void add_levels(const Making& making) {
  std::vector<MipLevel>& levels = making.pyramid.levels;
  levels.push_back(make_level(making.input.scene.width, making.input.scene.height));
  while (levels.size() < std::max(making.ladder.size(), std::size_t{2}) ||
         levels.back().width > 1 || levels.back().height > 1) {
    levels.push_back(make_level((levels.back().width + 1) / 2, (levels.back().height + 1) / 2));
  }
  std::size_t floats[2] = {}, used[2] = {};
  share_memory(making, {nullptr, nullptr}, floats);
  auto& memory = making.pyramid.memory;
  for (int i = 0; i < 2; ++i) memory[i].reset(new float[floats[i]]);  // not initialised
  share_memory(making, {memory[0].get(), memory[1].get()}, used);
}

}  // namespace

MipPyramid make_mip_pyramid(const DofInput& input, const std::vector<MipLevelRungs>& ladder,
                            ThreadPool& pool) {
  MipPyramid pyramid;
  const Making making{input, ladder, pyramid, pool};
  add_levels(making);
  start_near(making);
  if (pyramid.any_near) {
    fill_holes(making);
    make_side(making, MipSide::near);
  }
  start_far(making);
  make_side(making, MipSide::far);
  return pyramid;
}

unsigned rungs_near(const MipLevel& level, MipSide side, int x, int y, int width, int height) {
  const int left = std::clamp((x - kMipReach) / kMipBlockWidth, 0, level.block_columns - 1);
  const int right =
      std::clamp((x + width - 1 + kMipReach) / kMipBlockWidth, 0, level.block_columns - 1);
  const int top = std::clamp((y - kMipReach) / kMipBlockHeight, 0, level.block_rows - 1);
  const int bottom =
      std::clamp((y + height - 1 + kMipReach) / kMipBlockHeight, 0, level.block_rows - 1);
  const std::vector<std::uint8_t>& marks = level.marks[static_cast<int>(side)];
  unsigned rungs = 0;
  for (int row = top; row <= bottom; ++row) {
    for (int column = left; column <= right; ++column) {
      rungs |= marks[static_cast<std::size_t>(row * level.block_columns + column)];
    }
  }
  return rungs;
}

void read_mip_row(const DofInput& input, const MipPyramid& pyramid, RungStep near, int x, int y,
                  int count, bool fill, MipPictureRow& to, Isa isa) {
  if (!fill) {
    split_disc_row(input, x, y, count, to.far[0], kMipTileRow, isa);
    SOFTFOCUS_KERNEL(isa, keep_far_squares)(to.far[3], count);
    return;
  }
  const MipLevel& half = pyramid.levels[1];
  const int other = std::clamp(y % 2 == 0 ? y / 2 - 1 : y / 2 + 1, 0, half.height - 1);
  const int half_x = x < 0 ? -(-x / 2) : x / 2;
  split_disc_row(input, x, y, count, to.near[0], kMipTileRow, isa);
  SOFTFOCUS_KERNEL(isa, fill_picture_row)
  (plane_row(half.filled, 0, y / 2) + half_x, plane_row(half.filled, 0, other) + half_x,
   half.filled.plane, near, count, to.near[0], to.far[0], kMipTileRow);
  // Outside, the picture's edges repeat.
  const int width = input.scene.width;
  for (float* row : {to.far[0], to.far[1], to.far[2], to.far[3]}) {
    if (x < 0) std::fill_n(row, -x, row[-x]);
    if (x + count > width) std::fill(row + width - x, row + count, row[width - 1 - x]);
  }
}

}  // namespace softfocus

#else  // kernels

namespace {

#include "dof/level_lanes.inl"

}  // namespace

/// Adds the rungs of whole blocks of pixels, a bit each, to their marks, and returns them all.
/// Without weights all are 1.
unsigned mark_mip_row(const float* square, const float* weight, float sign, int count,
                      const MipSteps& steps, std::uint8_t* marks) {
  unsigned all = 0;
  for (int block = 0; block < count; block += kMipBlockWidth) {
    unsigned bits = 0;
    for (int x = block; x < block + kMipBlockWidth; x += kLanes) {
      const Floats value = sign * load(square + x);
      const Mask there = weight == nullptr ? splat(-1) : load(weight + x) > 0.0f;
      Floats begun = splat(1.0f);
      for (int i = 0; i <= steps.rungs; ++i) {
        const Floats ended = i < steps.rungs ? share_from(steps.steps[i + 1], value) : splat(0.0f);
        if (any(there & (begun - ended > 0.0f))) bits |= 1u << i;
        begun = ended;
      }
    }
    marks[block / kMipBlockWidth] |= static_cast<std::uint8_t>(bits);
    all |= bits;
  }
  return all;
}

/// A row of a side at half size, of what belongs beyond the level. Squares count times `sign`.
void halve_mip_rows(const MipHalving& in, float sign) {
  for (int x = 0; x < in.count; x += kLanes) {
    const Halved half = halve_rows(in.rows, 2 * x, sign, in.beyond, in.least_square);
    for (int i = 0; i < kLevelChannels; ++i) store(in.to + i * in.plane + x, half.channel[i]);
  }
}

/// Two rows of the picture, colours and signed squares, at half size without what lies before
/// the focus.
void halve_holed_picture(const float* upper, const float* lower, std::ptrdiff_t channel,
                         RungStep near, int count, float* to, std::ptrdiff_t plane) {
  const float* const rows[2] = {upper, lower};
  for (int x = 0; x < count; x += kLanes) {
    Floats sums[kHoledChannels][2];
    for (int half = 0; half < 2; ++half) {
      const int at = 2 * x + half * kLanes;
      for (int i = 0; i < kHoledChannels; ++i) sums[i][half] = splat(0.0f);
      for (const float* row : rows) {
        const Floats square = load(row + 3 * channel + at);
        const Floats weight = 1.0f - share_from(near, -square);
        for (int i = 0; i < 3; ++i) sums[i][half] += load(row + i * channel + at) * weight;
        sums[kFilledSquare][half] += larger(square, splat(0.0f)) * weight;
        sums[kHoledWeight][half] += weight;
      }
    }
    for (int i = 0; i < kHoledChannels; ++i) {
      store(to + i * plane + x, 0.25f * add_pairs(sums[i][0], sums[i][1]));
    }
  }
}

void halve_holed_rows(const float* upper, const float* lower, std::ptrdiff_t channel, int count,
                      float* to, std::ptrdiff_t plane) {
  for (int x = 0; x < count; x += kLanes) {
    for (int i = 0; i < kHoledChannels; ++i) {
      const float* above = upper + i * channel + 2 * x;
      const float* below = lower + i * channel + 2 * x;
      const Floats sum =
          add_pairs(load(above) + load(below), load(above + kLanes) + load(below + kLanes));
      store(to + i * plane + x, 0.25f * sum);
    }
  }
}

/// Fills a row with holes in place from the two rows of the next level around it; without
/// those, what is there is all. Colours and squares no longer count times weight then.
void fill_mip_row(const float* inside, const float* other, std::ptrdiff_t next_plane, int count,
                  float* row, std::ptrdiff_t plane) {
  for (int x = 0; x < count; x += 2 * kLanes) {
    Floats inverse[2], share[2];
    for (int half = 0; half < 2; ++half) {
      const Floats weight = load(row + kHoledWeight * plane + x + half * kLanes);
      const Mask any = weight > 0.0f;
      inverse[half] = select(any, 1.0f / select(any, weight, splat(1.0f)), splat(0.0f));
      share[half] = inside == nullptr ? splat(1.0f) : smaller(kFillGain * weight, splat(1.0f));
    }
    for (int i = 0; i < kFilledChannels; ++i) {
      float* at = row + i * plane + x;
      const TwoVectors next = inside == nullptr ? TwoVectors{splat(0.0f), splat(0.0f)}
                                                : enlarge(inside + i * next_plane + x / 2,
                                                          other + i * next_plane + x / 2);
      store(at, mix(next.first, load(at) * inverse[0], share[0]));
      store(at + kLanes, mix(next.second, load(at + kLanes) * inverse[1], share[1]));
    }
  }
}

/// A row of the picture, colours and signed squares, with what lies before the focus filled
/// from rows of twice the size.
void fill_picture_row(const float* inside, const float* other, std::ptrdiff_t plane, RungStep near,
                      int count, float* from, float* to, std::ptrdiff_t channel) {
  for (int x = 0; x < count; x += 2 * kLanes) {
    Floats holes[2];
    for (int half = 0; half < 2; ++half) {
      float* square = from + 3 * channel + x + half * kLanes;
      const Floats value = load(square);
      holes[half] = share_from(near, -value);
      store(to + 3 * channel + x + half * kLanes, larger(value, splat(0.0f)));
      store(square, larger(-value, splat(0.0f)));
    }
    for (int i = 0; i < kFilledChannels; ++i) {
      const TwoVectors filled = enlarge(inside + i * plane + x / 2, other + i * plane + x / 2);
      const float* own = (i == kFilledSquare ? to : from) + i * channel + x;
      const Floats lower = load(own), upper = load(own + kLanes);
      store(to + i * channel + x, mix(lower, filled.first, holes[0]));
      store(to + i * channel + x + kLanes, mix(upper, filled.second, holes[1]));
    }
  }
}

/// Signed squares without those before the focus.
void keep_far_squares(float* square, int count) {
  for (int x = 0; x < count; x += kLanes) {
    store(square + x, larger(load(square + x), splat(0.0f)));
  }
}

#endif

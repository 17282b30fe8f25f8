#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "dof/disc_layers/disc_levels.h"

#include <algorithm>
#include <array>
#include <utility>

#include "dof/picture_planes.h"
#include "raster/threads/scratch_shelf.h"

namespace softfocus {

// Rungs of a level on either side, a bit each; the last bit stands for all larger ones.
struct MarkedRungs {
  std::uint32_t near, far;
};

// Two rows of a level, to become one of the next.
struct DiscHalving {
  DiscRow rows[2];
  float sign;  // of the squares that count
  RungStep beyond;
  float least_square;  // of the next level
  int count;           // pixels of the result
  float* to;           // its channels, `plane` floats apart
  std::ptrdiff_t plane;
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "dof/disc_layers/disc_levels.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

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

// A task's memory. Rows have room for whole vectors.
struct RowScratch {
  std::vector<float> split[2];          // two rows of level 0: colours and signed squares
  std::vector<std::uint32_t> marks[2];  // of either side, by x: the rungs in a row of blocks
  std::vector<std::uint32_t> next_marks[2];
};

// Moves the marks of a row of blocks into the level.
void keep_marks(DiscLevel& level, int side, int y, std::vector<std::uint32_t>& marks) {
  std::uint32_t* blocks =
      &level.rungs[side][static_cast<std::size_t>(y / kDiscBlock * level.block_columns)];
  for (int column = 0; column < level.block_columns; ++column) {
    const std::uint32_t* from = marks.data() + column * kDiscBlock;
    std::uint32_t any = 0;
    for (int i = 0; i < kDiscBlock; ++i) any |= from[i];
    blocks[column] = any;
  }
  std::fill(marks.begin(), marks.end(), 0u);
}

void repeat_ends(const DiscLevel& level, float* row, std::ptrdiff_t stride) {
  std::fill_n(row, kDiscMargin, row[kDiscMargin]);
  std::fill(row + kDiscMargin + level.width, row + stride, row[kDiscMargin + level.width - 1]);
}

int padded_width(const DiscLevel& level) { return level.width + 2 * kDiscMargin + kDiscTileWidth; }

std::ptrdiff_t row_stride(const DiscLevel& level) { return plane_stride(padded_width(level)); }

// Whether a row has anything on a side. Rows below the last repeat it.
bool row_filled(const DiscLevel& level, int side, int y) {
  return level.filled[side][static_cast<std::size_t>(std::min(y, level.height - 1))] != 0;
}

// Gives every level but the first its planes.
std::unique_ptr<float[]> share_memory(std::vector<DiscLevel>& levels) {
  constexpr int kPlanes = 2 * (kDiscChannels + kDiscTransmitted + 1);
  std::size_t floats = 0;
  for (const DiscLevel& level : levels) {
    if (&level == &levels[0]) continue;
    floats += static_cast<std::size_t>(kPlanes * row_stride(level) * level.height);
  }
  auto memory = std::unique_ptr<float[]>(new float[floats]);  // not initialised
  float* next = memory.get();
  for (DiscLevel& level : levels) {
    if (&level == &levels[0]) continue;
    const std::ptrdiff_t plane = row_stride(level) * level.height;
    for (std::size_t side = 0; side < 2; ++side) {
      level.sides[side] = {row_stride(level), plane, next};
      next += kDiscChannels * plane;
      level.seen[side] = {row_stride(level), plane, next};
      next += (kDiscTransmitted + 1) * plane;
      level.filled[side].assign(static_cast<std::size_t>(level.height), 0);
    }
    level.zeros.assign(static_cast<std::size_t>(padded_width(level)), 0.0f);
  }
  return memory;
}

// Rows below the picture repeat its last.
const std::uint16_t* texel_row(const DofInput& input, int y) {
  return row<std::uint16_t>(input.scene, std::min(y, input.scene.height - 1)).data();
}

struct Halving {
  const DofInput& input;
  DiscLevel& from;
  DiscLevel& to;
  bool whole;  // whether `from` is the picture itself
  RungStep beyond;
  float least_square;
  int first_rung;  // of `to`
  const float* ones;
};

// Makes two rows of level 0 from the picture. `larger` becomes true for a side that has
// anything for the next level; if neither has, colours are left out.
void split_two_rows(const Halving& halving, int y, RowScratch& scratch, DiscRow* rows, bool* larger,
                    Isa isa) {
  const int width = halving.from.width, padded = padded_width(halving.from);
  for (int i = 0; i < 2; ++i) {
    float* row = scratch.split[i].data();
    rows[i] = {{row, row + padded, row + 2 * padded, halving.ones, row + 3 * padded}};
    SOFTFOCUS_KERNEL(isa, split_disc_squares)
    (halving.input.settings, texel_row(halving.input, y + i), 0, width, width + kDiscTileWidth,
     row + 3 * padded);
    const MarkedRungs marked = SOFTFOCUS_KERNEL(isa, mark_rungs)(
        row + 3 * padded, halving.ones, width, 0, scratch.marks[0].data(), scratch.marks[1].data());
    larger[0] = larger[0] || marked.near >> kFineRungs != 0;
    larger[1] = larger[1] || marked.far >> kFineRungs != 0;
  }
  if (!larger[0] && !larger[1]) return;
  for (int i = 0; i < 2; ++i) {
    SOFTFOCUS_KERNEL(isa, split_disc_colours)
    (texel_row(halving.input, y + i), 0, width, width + kDiscTileWidth, scratch.split[i].data(),
     padded);
  }
}

// Makes a row of a side of the next level.
void halve_rows(const Halving& halving, const DiscRow* rows, int side, int y, RowScratch& scratch,
                Isa isa) {
  DiscLevel& to = halving.to;
  const DiscPlanes& planes = to.sides[side];
  float* row = plane_row(planes, 0, y) + kDiscMargin;
  const DiscHalving halves{{rows[0], rows[1]}, halving.whole && side == 0 ? -1.0f : 1.0f,
                           halving.beyond,     halving.least_square,
                           to.width,           row,
                           planes.plane};
  SOFTFOCUS_KERNEL(isa, halve_disc_rows)(halves);
  std::uint32_t* marks = scratch.next_marks[side].data();
  const MarkedRungs marked = SOFTFOCUS_KERNEL(isa, mark_rungs)(
      row + kDiscSquare * planes.plane, row + kDiscWeight * planes.plane, to.width,
      halving.first_rung, marks, marks);
  to.filled[side][static_cast<std::size_t>(y)] = marked.far != 0;
  for (int i = 0; i < kDiscChannels; ++i) {
    repeat_ends(to, plane_row(planes, i, y), planes.stride);
  }
}

void halve_task(const Halving& halving, int task, RowScratch& scratch, Isa isa) {
  DiscLevel& from = halving.from;
  DiscLevel& to = halving.to;
  for (int side = 0; side < 2; ++side) {
    const auto padded = static_cast<std::size_t>(padded_width(from));
    if (halving.whole) scratch.split[side].resize(4 * padded);
    scratch.marks[side].resize(padded);
    scratch.next_marks[side].resize(padded);
  }
  const int end = std::min((task + 1) * kDiscBlock, to.height);
  for (int y = task * kDiscBlock; y < end; ++y) {
    for (int side = 0; side < 2; ++side) {
      DiscRow rows[2];
      bool larger[2] = {false, false};
      if (!halving.whole) {
        for (int i = 0; i < 2; ++i) {
          rows[i] = disc_row(from, side, 0, 2 * y + i);
          larger[side] = larger[side] || row_filled(from, side, 2 * y + i);
        }
        if (larger[side]) halve_rows(halving, rows, side, y, scratch, isa);
      } else if (side == 0) {
        split_two_rows(halving, 2 * y, scratch, rows, larger, isa);
        for (int i = 0; i < 2; ++i) {
          if (larger[i]) halve_rows(halving, rows, i, y, scratch, isa);
        }
      }
    }
    if (halving.whole && (2 * y + 2) % kDiscBlock == 0) {
      for (int i = 0; i < 2; ++i) keep_marks(from, i, 2 * y, scratch.marks[i]);
    }
  }
  for (int i = 0; i < 2; ++i) {
    if (halving.whole && (2 * end) % kDiscBlock != 0) {
      keep_marks(from, i, 2 * (end - 1), scratch.marks[i]);
    }
    keep_marks(to, i, end - 1, scratch.next_marks[i]);
  }
}

}  // namespace

void split_disc_row(const DofInput& input, int x, int y, int count, float* to,
                    std::ptrdiff_t channel, Isa isa) {
  const std::uint16_t* from = texel_row(input, y);
  SOFTFOCUS_KERNEL(isa, split_disc_colours)(from, x, input.scene.width, count, to, channel);
  SOFTFOCUS_KERNEL(isa, split_disc_squares)
  (input.settings, from, x, input.scene.width, count, to + 3 * channel);
}

DiscRow disc_row(const DiscLevel& level, int side, int x, int y) {
  const int inside = std::clamp(y, 0, level.height - 1);
  DiscRow row;
  if (!row_filled(level, side, inside)) {
    for (const float*& channel : row.channel) channel = level.zeros.data() + kDiscMargin + x;
    return row;
  }
  const DiscPlanes& planes = level.sides[side];
  const float* at = plane_row(planes, 0, inside) + kDiscMargin + x;
  for (int i = 0; i < kDiscChannels; ++i) row.channel[i] = at + i * planes.plane;
  return row;
}

DiscLevels make_disc_levels(const DofInput& input, const std::vector<LevelRungs>& ladder,
                            ThreadPool& pool) {
  DiscLevels result;
  std::vector<DiscLevel>& levels = result.levels;
  levels.push_back(make_level(input.scene.width, input.scene.height));
  // At least one halving: it marks the rungs of level 0.
  while (levels.size() < std::max(ladder.size(), std::size_t{2})) {
    levels.push_back(make_level((levels.back().width + 1) / 2, (levels.back().height + 1) / 2));
  }
  result.memory = share_memory(levels);
  const std::vector<float> ones(static_cast<std::size_t>(padded_width(levels[0])), 1.0f);
  int first_rung = kFineRungs;
  for (std::size_t i = 0; i + 1 < levels.size(); ++i, first_rung += kLevelRungs) {
    const float square = i + 1 < ladder.size() ? ladder[i + 1].rungs[0].square : 0.0f;
    const Halving halving{input,  levels[i],  levels[i + 1], i == 0, ladder[i].beyond,
                          square, first_rung, ones.data()};
    ScratchShelf<RowScratch> shelf;
    pool.for_each((levels[i + 1].height + kDiscBlock - 1) / kDiscBlock, [&](int task) {
      RowScratch scratch = shelf.take();
      halve_task(halving, task, scratch, pool.isa());
      shelf.put_back(std::move(scratch));
    });
  }
  levels.resize(ladder.size());
  return result;
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

#else  // kernels

namespace {

#include "dof/picture_lanes.inl"

// Lanes 0, 2, 4, ... or 1, 3, 5, ... of two vectors.
template <std::size_t first, std::size_t... lane>
SOFTFOCUS_INLINE Floats every_other(Floats a, Floats b, std::index_sequence<lane...>) {
  return __builtin_shufflevector(a, b, (2 * lane + first)...);
}
SOFTFOCUS_INLINE Floats add_pairs(Floats a, Floats b) {
  using Lanes = std::make_index_sequence<SOFTFOCUS_LANES>;
  return every_other<0>(a, b, Lanes{}) + every_other<1>(a, b, Lanes{});
}

}  // namespace

/// The signed squares of the radii of `count` pixels of a row from `x` on. The picture's edges
/// repeat outwards.
void split_disc_squares(const DofSettings& settings, const std::uint16_t* from, int x, int width,
                        int count, float* to) {
  for (int i = 0; i < count; i += kLanes) {
    const Floats radius =
        split_radius(settings, half_to_float(load_repeating(from, x + i, width).a));
    store(to + i, select(radius < 0.0f, -(radius * radius), radius * radius));
  }
}

/// The colours of those pixels, `channel` floats apart.
void split_disc_colours(const std::uint16_t* from, int x, int width, int count, float* to,
                        std::ptrdiff_t channel) {
  for (int i = 0; i < count; i += kLanes) {
    const HalfTexels texels = load_repeating(from, x + i, width);
    store(to + i, finite_colour(texels.r));
    store(to + channel + i, finite_colour(texels.g));
    store(to + 2 * channel + i, finite_colour(texels.b));
  }
}

void halve_disc_rows(const DiscHalving& in) {
  for (int x = 0; x < in.count; x += kLanes) {
    Floats sums[kDiscChannels][2];
    for (int half = 0; half < 2; ++half) {
      const int at = 2 * x + half * kLanes;
      for (int i = 0; i < kDiscChannels; ++i) sums[i][half] = splat(0.0f);
      for (const DiscRow& row : in.rows) {
        const Floats square = in.sign * load(row.channel[kDiscSquare] + at);
        const Floats share = saturate((square - in.beyond.begin) * in.beyond.slope);
        const Floats weight = load(row.channel[kDiscWeight] + at) * share;
        for (int i = 0; i < 3; ++i) sums[i][half] += load(row.channel[i] + at) * share;
        sums[kDiscWeight][half] += weight;
        sums[kDiscSquare][half] += weight * larger(square, splat(in.least_square));
      }
    }
    for (int i = 0; i < 4; ++i) {
      store(in.to + i * in.plane + x, 0.25f * add_pairs(sums[i][0], sums[i][1]));
    }
    const Floats weight = add_pairs(sums[kDiscWeight][0], sums[kDiscWeight][1]);
    const Floats square = add_pairs(sums[kDiscSquare][0], sums[kDiscSquare][1]);
    store(in.to + kDiscSquare * in.plane + x, select(weight > 0.0f, square / weight, splat(0.0f)));
  }
}

/// Adds each pixel's rungs, a bit each, to its marks: to `near` if its square is negative, else
/// to `far`. Bit 0 stands for rung `first_rung` and smaller ones. Returns all rungs of the row.
MarkedRungs mark_rungs(const float* square, const float* weight, int count, int first_rung,
                       std::uint32_t* near, std::uint32_t* far) {
  // A float's upper bits count half octaves from 2^-127: 254 is 1 to 3/2, where rung 1 begins.
  const Ints offset = splat(253 + first_rung);
  Bits all_near = splat(0u), all_far = splat(0u);
  for (int x = 0; x < count; x += kLanes) {
    const Floats value = load(square + x);
    const Bits magnitude = as_bits(absolute(value));
    const Ints rung = smaller(larger((Ints)(magnitude >> 22) - offset, splat(0)), splat(30));
    const Bits own = select((magnitude & 0x3FFFFFu) == 0u, splat(1u), splat(3u)) << (Bits)rung;
    const Bits bits = select(load(weight + x) > 0.0f, own, splat(0u));
    const Bits near_bits = select(value < 0.0f, bits, splat(0u));
    const Bits far_bits = select(value < 0.0f, splat(0u), bits);
    store(near + x, load(near + x) | near_bits);
    store(far + x, load(far + x) | far_bits);
    all_near |= near_bits;
    all_far |= far_bits;
  }
  MarkedRungs marked{};
  for (int i = 0; i < kLanes; ++i) {
    marked.near |= all_near[i];
    marked.far |= all_far[i];
  }
  return marked;
}

#endif

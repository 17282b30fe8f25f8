#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "dof/disc_layers/disc_levels.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "dof/picture_planes.h"
#include "raster/threads/loops.h"

namespace softfocus {

// Pixels of a row that are halved together, or left out together if none counts to a larger
// level.
constexpr int kChunk = kLevelTileWidth;
static_assert(kChunk % kHiddenStrip == 0 && kChunk % kDiscBlock == 0);

// Marks of a row of level 0.
struct RowMarks {
  std::uint32_t *near, *far;  // by x: a bit for each rung; the last bit stands for all larger ones
  std::uint8_t* larger;       // of a chunk: a bit for each side that goes to larger levels
};

// A row's hidden light: texels, and for each strip whether it has any.
struct HiddenRow {
  const std::uint16_t* texels;
  const std::uint8_t* strips;
  int count;
};

// Two rows of a level, to become one of the next.
struct DiscHalving {
  LevelRow rows[2];
  float sign;  // of the squares that count
  RungStep beyond;
  float least_square;    // of the next level
  int first_rung;        // of the next level
  int count;             // pixels of the result
  float* to;             // its channels, `plane` floats apart
  std::uint32_t* marks;  // of its rungs, by x
  std::ptrdiff_t plane;
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "dof/disc_layers/make_disc_levels.cpp"
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

using FloatRow = std::vector<float, RowAllocator<float>>;

// A row of level 0, with room for whole chunks: colours and signed squares. Colours are known in
// chunks that are halved, what is hidden in chunks that have any.
struct SplitRow {
  FloatRow scene, hidden;
  std::vector<std::uint8_t> any_hidden;  // of a chunk
};

// A task's memory.
struct RowScratch {
  SplitRow rows[2];
  std::vector<std::uint8_t> larger;  // of a chunk: a bit for each side that goes to larger levels
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

int padded_width(const DiscLevel& level) {
  return level.width + kSeenRoom.before + kSeenRoom.after;
}

// Gives every level but the first its planes, or counts their floats.
std::size_t take_level_planes(std::vector<DiscLevel>& levels, float* memory) {
  std::size_t used = 0;
  for (std::size_t i = 1; i < levels.size(); ++i) {
    DiscLevel& level = levels[i];
    for (std::size_t side = 0; side < 2; ++side) {
      level.sides[side] = take_planes(kLevelChannels, level.width, level.height, memory, used);
      level.seen[side] = take_planes(kSeenChannels, level.width, level.height, memory, used);
      level.filled[side].assign(static_cast<std::size_t>(level.height), 0);
    }
    level.zeros.assign(static_cast<std::size_t>(padded_width(level)), 0.0f);
  }
  return used;
}

// Rows below the picture repeat its last.
const std::uint16_t* texel_row(const ConstImageView& picture, int y) {
  return row<std::uint16_t>(picture, std::min(y, picture.height - 1)).data();
}

struct Halving {
  const DofInput& input;
  const HiddenPicture& hidden;
  DiscLevel& from;
  DiscLevel& to;
  bool whole;  // whether `from` is the picture itself
  RungStep beyond;
  float least_square;
  int first_rung;  // of `to`
  const float* ones;
};

int chunks_of(const DiscLevel& level) { return (level.width + kChunk - 1) / kChunk; }

// Channels of a row of level 0 from x on in a task's memory.
LevelRow row_at(const Halving& halving, const FloatRow& memory, int x) {
  const int padded = padded_width(halving.from);
  const float* row = memory.data() + x;
  return {{row, row + padded, row + 2 * padded, halving.ones, row + 3 * padded}};
}

// Finds the squares of a row of level 0, those of what is hidden too, and marks its rungs.
void split_row(const Halving& halving, int y, SplitRow& row, RowScratch& scratch, Isa isa) {
  const int width = halving.from.width, padded = padded_width(halving.from);
  const int chunks = chunks_of(halving.from);
  const RowMarks marks{scratch.marks[0].data(), scratch.marks[1].data(), scratch.larger.data()};
  row.scene.resize(static_cast<std::size_t>(4 * padded));
  float* squares = row.scene.data() + 3 * padded;
  SOFTFOCUS_KERNEL(isa, split_squares)
  (halving.input.settings, texel_row(halving.input.scene, y), width, chunks, squares, marks);
  row.any_hidden.assign(static_cast<std::size_t>(chunks), 0);
  const HiddenPicture& hidden = halving.hidden;
  if (hidden.empty() || hidden.rows[static_cast<std::size_t>(y)] == 0) return;
  row.hidden.resize(static_cast<std::size_t>(4 * padded));
  const HiddenRow of_row{texel_row(hidden.picture, y), hidden.strips_of(y), hidden.strip_columns};
  SOFTFOCUS_KERNEL(isa, split_hidden_squares)
  (halving.input.settings, of_row, width, squares, row.hidden.data() + 3 * padded,
   row.any_hidden.data(), marks);
}

// Finds the colours of a chunk, `behind` those of what is hidden too.
void split_colours(const Halving& halving, int y, int chunk, bool behind, SplitRow& row, Isa isa) {
  const int width = halving.from.width, padded = padded_width(halving.from);
  const int x = chunk * kChunk;
  SOFTFOCUS_KERNEL(isa, split_disc_colours)
  (texel_row(halving.input.scene, y), x, width, kChunk, row.scene.data() + x, padded);
  if (!behind || row.any_hidden[static_cast<std::size_t>(chunk)] == 0) return;
  for (int i = 0; i < 3; ++i) {
    std::copy_n(row.scene.data() + i * padded + x, kChunk, row.hidden.data() + i * padded + x);
  }
  for (int at = x; at < std::min(x + kChunk, width); at += kHiddenStrip) {
    if (!halving.hidden.strip(at / kHiddenStrip, y)) continue;
    SOFTFOCUS_KERNEL(isa, split_disc_colours)
    (texel_row(halving.hidden.picture, y), at, width, kHiddenStrip, row.hidden.data() + at, padded);
  }
}

// Makes a row of a side of the next level, 0 in chunks that have nothing for it. `rows_at` gives
// the two rows of a chunk.
template <class RowsAt>
void halve_rows(const Halving& halving, int side, int y, RowScratch& scratch, Isa isa,
                const RowsAt& rows_at) {
  DiscLevel& to = halving.to;
  const std::vector<std::uint8_t>& larger = scratch.larger;
  const auto counts = [&](std::uint8_t sides) { return (sides >> side & 1) != 0; };
  if (std::none_of(larger.begin(), larger.end(), counts)) return;
  const LevelPlanes& planes = to.sides[side];
  const float sign = halving.whole && side == 0 ? -1.0f : 1.0f;
  bool filled = false;
  for (int chunk = 0; chunk < chunks_of(halving.from); ++chunk) {
    const int x = chunk * kChunk / 2, count = std::min(kChunk / 2, to.width - x);
    float* row = plane_row(planes, 0, y) + x;
    if (!counts(larger[static_cast<std::size_t>(chunk)])) {
      for (int i = 0; i < kLevelChannels; ++i) std::fill_n(row + i * planes.plane, count, 0.0f);
      continue;
    }
    const DiscHalving halves{{rows_at(chunk, 0), rows_at(chunk, 1)},
                             sign,
                             halving.beyond,
                             halving.least_square,
                             halving.first_rung,
                             count,
                             row,
                             scratch.next_marks[side].data() + x,
                             planes.plane};
    filled |= SOFTFOCUS_KERNEL(isa, halve_disc_rows)(halves);
  }
  to.filled[side][static_cast<std::size_t>(y)] = filled;
  repeat_ends(planes, kLevelChannels, to.width, y);
}

// Makes a row of level 1 from two rows of the picture.
void halve_picture_rows(const Halving& halving, int y, RowScratch& scratch, Isa isa) {
  const int last = halving.from.height - 1;
  for (int i = 0; i < 2; ++i) {
    split_row(halving, std::min(2 * y + i, last), scratch.rows[i], scratch, isa);
  }
  for (int chunk = 0; chunk < chunks_of(halving.from); ++chunk) {
    const std::uint8_t sides = scratch.larger[static_cast<std::size_t>(chunk)];
    for (int i = 0; sides != 0 && i < 2; ++i) {
      split_colours(halving, std::min(2 * y + i, last), chunk, (sides & 2) != 0, scratch.rows[i],
                    isa);
    }
  }
  for (int side = 0; side < 2; ++side) {
    halve_rows(halving, side, y, scratch, isa, [&](int chunk, int i) {
      const SplitRow& row = scratch.rows[i];
      const bool hidden = side == 1 && row.any_hidden[static_cast<std::size_t>(chunk)] != 0;
      return row_at(halving, hidden ? row.hidden : row.scene, chunk * kChunk);
    });
  }
}

// Makes a row of a level from two of the one before.
void halve_level_rows(const Halving& halving, int y, RowScratch& scratch, Isa isa) {
  const DiscLevel& from = halving.from;
  for (int side = 0; side < 2; ++side) {
    const std::uint32_t* blocks =
        &from.rungs[side][static_cast<std::size_t>(2 * y / kDiscBlock * from.block_columns)];
    for (int column = 0; column < from.block_columns; ++column) {
      if (blocks[column] >> kLevelRungs == 0) continue;
      scratch.larger[static_cast<std::size_t>(column * kDiscBlock / kChunk)] |=
          static_cast<std::uint8_t>(1 << side);
    }
    halve_rows(halving, side, y, scratch, isa,
               [&](int chunk, int i) { return disc_row(from, side, chunk * kChunk, 2 * y + i); });
  }
}

void halve_task(const Halving& halving, int task, RowScratch& scratch, Isa isa) {
  DiscLevel& from = halving.from;
  DiscLevel& to = halving.to;
  for (int side = 0; side < 2; ++side) {
    const auto padded = static_cast<std::size_t>(padded_width(from));
    scratch.marks[side].resize(padded);
    scratch.next_marks[side].resize(padded);
  }
  const int end = std::min((task + 1) * kDiscBlock, to.height);
  for (int y = task * kDiscBlock; y < end; ++y) {
    scratch.larger.assign(static_cast<std::size_t>(chunks_of(from)), 0);
    (halving.whole ? halve_picture_rows : halve_level_rows)(halving, y, scratch, isa);
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
  SOFTFOCUS_KERNEL(isa, split_disc_row)
  (input.settings, texel_row(input.scene, y), x, input.scene.width, count, to, channel);
}

DiscLevels make_disc_levels(const DofInput& input, const HiddenPicture& hidden,
                            const std::vector<LevelRungs>& ladder, ThreadPool& pool) {
  DiscLevels result;
  std::vector<DiscLevel>& levels = result.levels;
  levels.push_back(make_level(input.scene.width, input.scene.height));
  // At least one halving: it marks the rungs of level 0.
  while (levels.size() < std::max(ladder.size(), std::size_t{2})) {
    levels.push_back(make_level((levels.back().width + 1) / 2, (levels.back().height + 1) / 2));
  }
  result.memory = make_row_memory<float>(take_level_planes(levels, nullptr), &pool.memory());
  take_level_planes(levels, result.memory.get());
  const FloatRow ones(static_cast<std::size_t>(padded_width(levels[0])), 1.0f);
  int first_rung = kFineRungs;
  for (std::size_t i = 0; i + 1 < levels.size(); ++i, first_rung += kLevelRungs) {
    const float square = i + 1 < ladder.size() ? ladder[i + 1].rungs[0].square : 0.0f;
    const Halving halving{input,  hidden,     levels[i],  levels[i + 1], i == 0, ladder[i].beyond,
                          square, first_rung, ones.data()};
    for_each_with<RowScratch>(
        pool, (levels[i + 1].height + kDiscBlock - 1) / kDiscBlock,
        [&](int task, auto& scratch) { halve_task(halving, task, scratch, pool.isa()); });
  }
  levels.resize(ladder.size());
  return result;
}

}  // namespace softfocus

#else  // kernels

namespace {

#include "dof/level_lanes.inl"

SOFTFOCUS_INLINE Floats signed_squares(const DofSettings& settings, const HalfTexels& texels) {
  const Floats radius = split_radius(settings, half_to_float(texels.a));
  return select(radius < 0.0f, -(radius * radius), radius * radius);
}

struct LaneRungs {
  Bits near, far;
};

// A bit for each pixel's rungs: `near` if its square is negative, else `far`. Bit 0 stands for rung
// `first_rung` and smaller ones.
SOFTFOCUS_INLINE LaneRungs rungs_of(Floats square, Mask counts, int first_rung) {
  // A float's upper bits count half octaves from 2^-127: 254 is 1 to 3/2, where rung 1 begins.
  const Ints offset = splat(253 + first_rung);
  const Bits magnitude = as_bits(absolute(square));
  const Ints rung = smaller(larger((Ints)(magnitude >> 22) - offset, splat(0)), splat(30));
  const Bits own = select((magnitude & 0x3FFFFFu) == 0u, splat(1u), splat(3u)) << (Bits)rung;
  const Bits bits = select(counts, own, splat(0u));
  const Mask near = square < 0.0f;
  return {select(near, bits, splat(0u)), select(near, splat(0u), bits)};
}

SOFTFOCUS_INLINE void mark_rungs(const LaneRungs& rungs, const RowMarks& marks, int x,
                                 LaneRungs& all) {
  store(marks.near + x, load(marks.near + x) | rungs.near);
  store(marks.far + x, load(marks.far + x) | rungs.far);
  all.near |= rungs.near;
  all.far |= rungs.far;
}

// The sides that have rungs larger than those of level 0.
SOFTFOCUS_INLINE std::uint8_t larger_sides(const LaneRungs& all) {
  return static_cast<std::uint8_t>((any(all.near >> kFineRungs != 0u) ? 1 : 0) |
                                   (any(all.far >> kFineRungs != 0u) ? 2 : 0));
}

SOFTFOCUS_INLINE void store_colours(float* to, std::ptrdiff_t channel, const HalfTexels& texels) {
  store(to, finite_colour(texels.r));
  store(to + channel, finite_colour(texels.g));
  store(to + 2 * channel, finite_colour(texels.b));
}

}  // namespace

/// The signed squares of the radii of a row of level 0, in whole chunks, and its rungs. The
/// picture's edges repeat outwards.
void split_squares(const DofSettings& settings, const std::uint16_t* from, int width, int chunks,
                   float* to, const RowMarks& marks) {
  for (int chunk = 0; chunk < chunks; ++chunk) {
    LaneRungs all{splat(0u), splat(0u)};
    for (int x = chunk * kChunk; x < (chunk + 1) * kChunk; x += kLanes) {
      const Floats square = signed_squares(settings, load_repeating(from, x, width));
      store(to + x, square);
      mark_rungs(rungs_of(square, splat(-1), 0), marks, x, all);
    }
    marks.larger[chunk] |= larger_sides(all);
  }
}

/// Those of what is hidden in a row, but at least kLeastHidden; its rungs where it differs from the
/// scene. Defines them in chunks that have any, which it marks.
void split_hidden_squares(const DofSettings& settings, const HiddenRow& row, int width,
                          const float* scene, float* to, std::uint8_t* any_hidden,
                          const RowMarks& marks) {
  constexpr int kAhead = 4;
  for (int strip = 0; strip < row.count; ++strip) {
    if (strip + kAhead < row.count && row.strips[strip + kAhead] != 0) {
      const std::uint16_t* ahead = row.texels + 4 * (strip + kAhead) * kHiddenStrip;
      __builtin_prefetch(ahead);
      __builtin_prefetch(ahead + 4 * kTexelsOfLine);
    }
    if (row.strips[strip] == 0) continue;
    const int chunk = strip * kHiddenStrip / kChunk;
    if (any_hidden[chunk] == 0) {
      std::memcpy(to + chunk * kChunk, scene + chunk * kChunk, kChunk * sizeof *to);
    }
    any_hidden[chunk] = 1;
    LaneRungs all{splat(0u), splat(0u)};
    for (int x = strip * kHiddenStrip; x < (strip + 1) * kHiddenStrip; x += kLanes) {
      const Floats square = signed_squares(settings, load_repeating(row.texels, x, width));
      const Floats counted = larger(square, splat(kLeastHidden));
      store(to + x, counted);
      mark_rungs(rungs_of(counted, square != load(scene + x), 0), marks, x, all);
    }
    marks.larger[chunk] |= larger_sides(all);
  }
}

/// The colours of those pixels, `channel` floats apart.
void split_disc_colours(const std::uint16_t* from, int x, int width, int count, float* to,
                        std::ptrdiff_t channel) {
  for (int i = 0; i < count; i += kLanes) {
    store_colours(to + i, channel, load_repeating(from, x + i, width));
  }
}

/// Both.
void split_disc_row(const DofSettings& settings, const std::uint16_t* from, int x, int width,
                    int count, float* to, std::ptrdiff_t channel) {
  for (int i = 0; i < count; i += kLanes) {
    const HalfTexels texels = load_repeating(from, x + i, width);
    store_colours(to + i, channel, texels);
    store(to + 3 * channel + i, signed_squares(settings, texels));
  }
}

/// Returns whether the row has anything.
bool halve_disc_rows(const DiscHalving& in) {
  Bits all = splat(0u);
  for (int x = 0; x < in.count; x += kLanes) {
    const Halved half = halve_rows(in.rows, 2 * x, in.sign, in.beyond, in.least_square);
    for (int i = 0; i < kLevelChannels; ++i) store(in.to + i * in.plane + x, half.channel[i]);
    const Bits rungs =
        rungs_of(half.channel[kLevelSquare], half.channel[kLevelWeight] > 0.0f, in.first_rung).far;
    store(in.marks + x, load(in.marks + x) | rungs);
    all |= rungs;
  }
  return any(all != 0u);
}

#endif

#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "dof/disc_layers/disc_layers.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "dof/disc_layers/disc_levels.h"
#include "raster/threads/scratch_shelf.h"

namespace softfocus {

constexpr int kDiscTileRow = kDiscTileWidth + 2 * kDiscMargin;
constexpr int kDiscTileRows = kDiscTileHeight + 2 * kDiscApron;

enum class DiscSide { near, focus, far };

// A rung to blur in a tile.
struct DiscBlur {
  const DiscRow* rows;  // at the tile's first pixel; the first lies reach + 1 rows above it
  int width, height;
  DiscSide side;
  float sign;  // of the squares of this side
  RungStep begin, end;
  const LadderSpan* spans;
  int reach;
  float area;  // the disc's sum where there is 1 everywhere
};

// What is seen of the rungs so far: colour and transmittance of a tile.
struct DiscTile {
  float channel[4][kDiscTileHeight][kDiscTileWidth];
};

// Where a rung is blurred.
struct DiscScratch {
  float share[kDiscTileRows][kDiscTileRow];
  float seen[kDiscTileRows][kDiscTileRow];  // the share of the rung and of all that it hides
  float product[kDiscTileRows][kDiscTileRow];
  float columns[2][kDiscApron][kDiscTileRow];                  // of the last two rows
  float sums[kDiscChannels][kDiscTileHeight][kDiscTileWidth];  // discs' sums; the last of `seen`
  int seen_sums;  // which sums are those of `seen`: kDiscWeight where both are the same
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "dof/disc_layers/disc_layers.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

struct Workspace {
  DiscTile tile;
  DiscScratch scratch;
  float picture[kDiscTileRows][4][kDiscTileRow];  // level 0: colours and signed squares
  float ones[kDiscTileRow];
  float enlarged[4][kDiscTileRow];
};

struct Frame {
  const DofInput& input;
  const std::vector<LevelRungs>& ladder;
  std::vector<DiscLevel>& levels;
  Isa isa;
};

struct Rectangle {
  int x, y, width, height;
};

// The reach of the largest of some rungs' discs.
int reach_of(const LevelRungs& level, std::uint32_t rungs) {
  std::size_t reach = 1;
  for (std::size_t i = 0; i < level.rungs.size(); ++i) {
    if ((rungs >> i & 1u) != 0) reach = std::max(reach, level.rungs[i].spans.size());
  }
  return static_cast<int>(reach) - 1;
}

// Splits a tile's part of the picture, with `apron` more rows above and below.
void split_tile(const Frame& frame, const Rectangle& at, int apron, Workspace& work) {
  const int last = frame.levels[0].height - 1;
  for (int y = -apron; y < at.height + apron; ++y) {
    split_disc_row(frame.input, at.x - kDiscMargin, std::clamp(at.y + y, 0, last), kDiscTileRow,
                   work.picture[y + kDiscApron][0], kDiscTileRow, frame.isa);
  }
}

void blur_rung(const Frame& frame, std::size_t level, DiscSide side, std::size_t number,
               const Rectangle& at, Workspace& work) {
  const LevelRungs& rungs = frame.ladder[level];
  const Rung& rung = rungs.rungs[number];
  const DiscLevel& picture = frame.levels[level];
  const int reach = static_cast<int>(rung.spans.size()) - 1;
  DiscRow rows[kDiscTileRows];
  for (int y = 0; y < at.height + 2 * (reach + 1); ++y) {
    if (level == 0) {
      const float(*const row)[kDiscTileRow] = work.picture[y + kDiscApron - reach - 1];
      rows[y] = {{row[0] + kDiscMargin, row[1] + kDiscMargin, row[2] + kDiscMargin,
                  work.ones + kDiscMargin, row[3] + kDiscMargin}};
    } else {
      rows[y] = disc_row(picture, side == DiscSide::near ? 0 : 1, at.x, at.y + y - reach - 1);
    }
  }
  const bool last = number + 1 == rungs.rungs.size();
  const DiscBlur blur{rows,
                      at.width,
                      at.height,
                      side,
                      level == 0 && side == DiscSide::near ? -1.0f : 1.0f,
                      rung.step,
                      last ? rungs.beyond : rungs.rungs[number + 1].step,
                      rung.spans.data(),
                      reach,
                      rung.area};
  SOFTFOCUS_KERNEL(frame.isa, blur_disc_tile)(blur, work.scratch);
  SOFTFOCUS_KERNEL(frame.isa, add_disc_sums)(work.scratch, at.width, at.height, work.tile);
}

// A tile's place in the next level, with the pixels around it that enlarging needs.
Rectangle in_next_level(const Rectangle& at) {
  return {at.x / 2 - 1, at.y / 2 - 1, at.width / 2 + 2, at.height / 2 + 2};
}

// Whether a level or a larger one has anything of that side to show in a rectangle.
bool any_seen(const Frame& frame, std::size_t level, int side, const Rectangle& at) {
  if (level == frame.levels.size()) return false;
  if (rungs_near(frame.levels[level], side, at.x, at.y, at.width, at.height) != 0) return true;
  return any_seen(frame, level + 1, side, in_next_level(at));
}

// Enlarges a row of what is seen of the next level to a tile's pixels.
void enlarge(const Frame& frame, const DiscLevel& from, int side, const Rectangle& at, int row,
             float* const (&to)[kDiscTransmitted + 1]) {
  const int y = at.y + row;
  const int inside = y / 2;
  const int other = std::clamp(y % 2 == 0 ? inside - 1 : inside + 1, 0, from.height - 1);
  for (int i = 0; i <= kDiscTransmitted; ++i) {
    SOFTFOCUS_KERNEL(frame.isa, enlarge_disc_row)
    (plane_row(from.seen[side], i, inside) + kDiscMargin + at.x / 2,
     plane_row(from.seen[side], i, other) + kDiscMargin + at.x / 2, at.width + at.width % 2, to[i]);
  }
}

void start_tile(const Frame& frame, std::size_t level, const Rectangle& at, bool before_focus,
                Workspace& work) {
  const bool any = before_focus && any_seen(frame, level + 1, 0, in_next_level(at));
  for (int y = 0; y < at.height; ++y) {
    const std::size_t row = static_cast<std::size_t>(y);
    float* const to[] = {work.tile.channel[0][row], work.tile.channel[1][row],
                         work.tile.channel[2][row], work.tile.channel[3][row]};
    if (any) {
      enlarge(frame, frame.levels[level + 1], 0, at, y, to);
    } else {
      for (int i = 0; i < 3; ++i) std::fill_n(to[i], kDiscTileWidth, 0.0f);
      std::fill_n(to[kDiscTransmitted], kDiscTileWidth, 1.0f);
    }
  }
}

void add_larger_behind(const Frame& frame, std::size_t level, const Rectangle& at,
                       Workspace& work) {
  if (!any_seen(frame, level + 1, 1, in_next_level(at))) return;
  float* const to[] = {work.enlarged[0], work.enlarged[1], work.enlarged[2], work.enlarged[3]};
  for (int y = 0; y < at.height; ++y) {
    enlarge(frame, frame.levels[level + 1], 1, at, y, to);
    SOFTFOCUS_KERNEL(frame.isa, add_behind)(work.enlarged, at.width, y, work.tile);
  }
}

void blur_before(const Frame& frame, std::size_t level, const Rectangle& at, Workspace& work) {
  const std::uint32_t rungs = rungs_near(frame.levels[level], 0, at.x, at.y, at.width, at.height);
  const std::size_t least = level == 0 ? 1 : 0;
  for (std::size_t i = frame.ladder[level].rungs.size(); i-- > least;) {
    if ((rungs >> i & 1u) != 0) blur_rung(frame, level, DiscSide::near, i, at, work);
  }
}

void blur_behind(const Frame& frame, std::size_t level, const Rectangle& at, Workspace& work) {
  const std::uint32_t rungs = rungs_near(frame.levels[level], 1, at.x, at.y, at.width, at.height);
  const std::size_t least = level == 0 ? 1 : 0;
  for (std::size_t i = least; i < frame.ladder[level].rungs.size(); ++i) {
    if ((rungs >> i & 1u) != 0) blur_rung(frame, level, DiscSide::far, i, at, work);
  }
}

template <class Body>
void for_each_tile(const DiscLevel& level, ThreadPool& pool, const Body& body) {
  const int columns = (level.width + kDiscTileWidth - 1) / kDiscTileWidth;
  const int rows = (level.height + kDiscTileHeight - 1) / kDiscTileHeight;
  ScratchShelf<std::unique_ptr<Workspace>> shelf;
  pool.for_each(columns * rows, [&](int task) {
    std::unique_ptr<Workspace> work = shelf.take();
    if (!work) {
      work = std::make_unique<Workspace>();
      std::fill_n(work->ones, kDiscTileRow, 1.0f);
    }
    const int x = task % columns * kDiscTileWidth, y = task / columns * kDiscTileHeight;
    body(Rectangle{x, y, std::min(kDiscTileWidth, level.width - x),
                   std::min(kDiscTileHeight, level.height - y)},
         *work);
    shelf.put_back(std::move(work));
  });
}

void keep_tile(DiscLevel& level, int side, const Rectangle& at, const DiscTile& tile) {
  for (int y = 0; y < at.height; ++y) {
    const std::size_t row = static_cast<std::size_t>(y);
    for (int i = 0; i < 4; ++i) {
      float* to = plane_row(level.seen[side], i, at.y + y) + kDiscMargin + at.x;
      std::copy_n(tile.channel[i][row], at.width, to);
      if (at.x == 0) to[-1] = to[0];
      if (at.x + at.width == level.width) to[at.width] = to[at.width - 1];
    }
  }
}

void see_level(const Frame& frame, std::size_t number, ThreadPool& pool) {
  DiscLevel& level = frame.levels[number];
  for_each_tile(level, pool, [&](const Rectangle& at, Workspace& work) {
    // Leaves out tiles that the level before does not read: its tiles read half their size and
    // two pixels more, if there is anything in them.
    constexpr int kAcross = kDiscTileWidth / 2 + 2, kDown = kDiscTileHeight / 2 + 2;
    const Rectangle around{at.x - kAcross, at.y - kDown, at.width + 2 * kAcross,
                           at.height + 2 * kDown};
    if (any_seen(frame, number, 0, around)) {
      start_tile(frame, number, at, true, work);
      blur_before(frame, number, at, work);
      keep_tile(level, 0, at, work.tile);
    }
    if (any_seen(frame, number, 1, around)) {
      start_tile(frame, number, at, false, work);
      blur_behind(frame, number, at, work);
      add_larger_behind(frame, number, at, work);
      keep_tile(level, 1, at, work.tile);
    }
  });
}

}  // namespace

std::vector<LevelRungs> disc_ladder_of(const DofInput& input) {
  return make_ladder(input.settings.max_coc_px);
}

void disc_layers(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  if (pool.isa() == Isa::scalar) return disc_layers_oracle(input, result, pool);
  const std::vector<LevelRungs> ladder = disc_ladder_of(input);
  DiscLevels made = make_disc_levels(input, ladder, pool);
  std::vector<DiscLevel>& levels = made.levels;
  const Frame frame{input, ladder, levels, pool.isa()};
  for (std::size_t i = levels.size(); i-- > 1;) see_level(frame, i, pool);
  for_each_tile(levels[0], pool, [&](const Rectangle& at, Workspace& work) {
    const std::uint32_t near = rungs_near(levels[0], 0, at.x, at.y, at.width, at.height);
    const std::uint32_t far = rungs_near(levels[0], 1, at.x, at.y, at.width, at.height);
    if ((near | far) != 0) split_tile(frame, at, reach_of(ladder[0], near | far) + 1, work);
    start_tile(frame, 0, at, true, work);
    blur_before(frame, 0, at, work);
    if (((near | far) & 1u) != 0) blur_rung(frame, 0, DiscSide::focus, 0, at, work);
    blur_behind(frame, 0, at, work);
    add_larger_behind(frame, 0, at, work);
    SOFTFOCUS_KERNEL(pool.isa(), store_disc_tile)
    (work.tile, row<std::uint16_t>(input.scene, at.y).data() + 4 * at.x,
     input.scene.stride_bytes / 2, at.width, at.height, input.profile.half_store,
     row<std::uint16_t>(result, at.y).data() + 4 * at.x, result.stride_bytes / 2);
  });
}

}  // namespace softfocus

#else  // kernels

namespace {

#include "dof/picture_lanes.inl"

/// How much belongs to a rung or to larger ones.
SOFTFOCUS_INLINE Floats share_from(RungStep step, Floats square) {
  return saturate((square - step.begin) * step.slope);
}

// Lanes from `from` on, of `a` and `b` by turns.
template <std::size_t from, std::size_t... lane>
SOFTFOCUS_INLINE Floats by_turns(Floats a, Floats b, std::index_sequence<lane...>) {
  return __builtin_shufflevector(a, b, (from + lane / 2 + (lane & 1) * kLanes)...);
}

// Vectors that are worked on together, so that spans are fetched once for all of them. They
// divide a row of a tile with its margins, and one without.
using ColumnVectors = std::make_index_sequence<5>;
using TileVectors = std::make_index_sequence<4>;
static_assert(kDiscTileRow % (5 * 16) == 0 && kDiscTileWidth % (4 * 16) == 0);

// Sums of a disc's columns; columns[dx] is for the columns dx pixels from the middle. `at`
// points into the middle row.
template <std::size_t... i>
SOFTFOCUS_INLINE void sum_columns(const float* at, const LadderSpan* spans, int reach,
                                  float* columns, std::index_sequence<i...>) {
  Floats sum[] = {load(at + i * kLanes)...};
  const float* above = at;
  const float* below = at;
  int dx = reach;
  for (int dy = 1;; ++dy) {
    above -= kDiscTileRow;
    below += kDiscTileRow;
    const Floats pair[] = {(load(above + i * kLanes) + load(below + i * kLanes))...};
    while (spans[dx].whole == dy - 1) {
      const Floats centre = splat(spans[dx].centre), end = splat(spans[dx].end);
      float* to = columns + dx * kDiscTileRow;
      ((store(to + i * kLanes, centre * sum[i] + end * pair[i])), ...);
      if (--dx < 0) return;
    }
    ((sum[i] += pair[i]), ...);
  }
}

// Adds the columns of discs.
template <std::size_t... i>
SOFTFOCUS_INLINE void add_columns(const float* columns, int reach, float* to,
                                  std::index_sequence<i...>) {
  Floats sum[] = {load(columns + i * kLanes)...};
  for (int dx = 1; dx <= reach; ++dx) {
    columns += kDiscTileRow;
    ((sum[i] += load(columns - dx + i * kLanes) + load(columns + dx + i * kLanes)), ...);
  }
  ((store(to + i * kLanes, sum[i])), ...);
}

// Discs' sums of a channel; `rows` begin reach + 1 rows above the tile. A row's columns are
// summed one row ahead: values just stored are slow to load at another alignment.
SOFTFOCUS_INLINE void sum_discs(const DiscBlur& in, const float (*rows)[kDiscTileRow],
                                DiscScratch& scratch, float (*to)[kDiscTileWidth]) {
  for (int y = 0; y <= in.height; ++y) {
    if (y < in.height) {
      for (int x = 0; x < kDiscTileRow; x += 5 * kLanes) {
        sum_columns(rows[y + in.reach + 1] + x, in.spans, in.reach, scratch.columns[y % 2][0] + x,
                    ColumnVectors{});
      }
    }
    if (y == 0) continue;
    for (int x = 0; x < kDiscTileWidth; x += 4 * kLanes) {
      add_columns(scratch.columns[1 - y % 2][0] + kDiscMargin + x, in.reach, to[y - 1] + x,
                  TileVectors{});
    }
  }
}

template <HalfRounding rounding>
SOFTFOCUS_INLINE void store_tile(const DiscTile& tile, const std::uint16_t* scene,
                                 std::ptrdiff_t scene_row, int width, int height, std::uint16_t* to,
                                 std::ptrdiff_t row) {
  for (int y = 0; y < height; ++y, scene += scene_row, to += row) {
    const bool aligned = reinterpret_cast<std::uintptr_t>(to) % sizeof(Bits) == 0;
    for (int x = 0; x < width; x += kLanes) {
      const Floats scale = 1.0f / (1.0f - load(tile.channel[kDiscTransmitted][y] + x));
      const HalfTexels texels{
          float_to_half<rounding>(clamp_to_half(load(tile.channel[0][y] + x) * scale)),
          float_to_half<rounding>(clamp_to_half(load(tile.channel[1][y] + x) * scale)),
          float_to_half<rounding>(clamp_to_half(load(tile.channel[2][y] + x) * scale)),
          stored_depth(load_repeating(scene, x, width).a)};
      if (x + kLanes <= width) {
        const TexelWords words = interleave(texels);
        aligned ? stream_texel_words(to + 4 * x, words) : store_texel_words(to + 4 * x, words);
      } else {
        std::uint16_t last[4 * kLanes];
        store_half_texels(last, texels);
        std::memcpy(to + 4 * x, last, 4 * sizeof *last * static_cast<std::size_t>(width - x));
      }
    }
  }
}

}  // namespace

/// Sums over the rung's discs: of its colours, of its share and of `seen`, into scratch.sums.
void blur_disc_tile(const DiscBlur& in, DiscScratch& scratch) {
  const int rows = in.height + 2 * (in.reach + 1);
  Mask all_ones = splat(-1), all_equal = splat(-1);
  for (int y = 0; y < rows; ++y) {
    const DiscRow& from = in.rows[y];
    for (int x = 0; x < kDiscTileRow; x += kLanes) {
      const Floats signed_square = load(from.channel[kDiscSquare] - kDiscMargin + x);
      const Floats weight = load(from.channel[kDiscWeight] - kDiscMargin + x);
      Floats share, seen;
      if (in.side == DiscSide::focus) {
        share = 1.0f - share_from(in.end, absolute(signed_square));
        seen = 1.0f - share_from(in.end, -signed_square);
      } else {
        const Floats square = in.sign * signed_square;
        const Floats begun = share_from(in.begin, square), ended = share_from(in.end, square);
        share = begun - ended;
        seen = in.side == DiscSide::near ? 1.0f - weight * ended : weight * begun;
      }
      store(scratch.share[y] + x, share);
      store(scratch.seen[y] + x, seen);
      all_ones &= seen == 1.0f;
      all_equal &= seen == weight * share;
    }
  }
  for (int i = 0; i < 4; ++i) {
    for (int y = 0; y < rows; ++y) {
      const float* from = in.rows[y].channel[i] - kDiscMargin;
      for (int x = 0; x < kDiscTileRow; x += kLanes) {
        store(scratch.product[y] + x, load(from + x) * load(scratch.share[y] + x));
      }
    }
    sum_discs(in, scratch.product, scratch, scratch.sums[i]);
  }
  scratch.seen_sums = kDiscChannels - 1;
  if (all(all_ones)) {
    for (int y = 0; y < in.height; ++y) {
      for (int x = 0; x < kDiscTileWidth; x += kLanes)
        store(scratch.sums[4][y] + x, splat(in.area));
    }
  } else if (all(all_equal)) {
    scratch.seen_sums = kDiscWeight;
  } else {
    sum_discs(in, scratch.seen, scratch, scratch.sums[4]);
  }
}

/// Adds a rung behind what is seen of nearer ones.
void add_disc_sums(const DiscScratch& in, int width, int height, DiscTile& tile) {
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; x += kLanes) {
      const Floats seen = load(in.sums[in.seen_sums][y] + x);
      float* through = tile.channel[kDiscTransmitted][y] + x;
      const Floats transmitted = load(through);
      const Mask any = seen > 0.0f;
      const Floats scale = select(any, transmitted / select(any, seen, splat(1.0f)), splat(0.0f));
      for (int i = 0; i < 3; ++i) {
        float* to = tile.channel[i][y] + x;
        store(to, load(to) + load(in.sums[i][y] + x) * scale);
      }
      store(through, larger(transmitted - load(in.sums[kDiscWeight][y] + x) * scale, splat(0.0f)));
    }
  }
}

/// Enlarges to a row of `count` pixels, an even number, from rows of pixels of twice the size:
/// three quarters of the row `inside` which it lies, a quarter of the `other`; along x likewise.
void enlarge_disc_row(const float* inside, const float* other, int count, float* to) {
  using Lanes = std::make_index_sequence<SOFTFOCUS_LANES>;
  for (int x = 0; x < count / 2; x += kLanes) {
    const Floats own = 0.75f * (0.75f * load(inside + x) + 0.25f * load(other + x));
    const Floats left = 0.75f * load(inside + x - 1) + 0.25f * load(other + x - 1);
    const Floats right = 0.75f * load(inside + x + 1) + 0.25f * load(other + x + 1);
    const Floats even = own + 0.25f * left, odd = own + 0.25f * right;
    store(to + 2 * x, by_turns<0>(even, odd, Lanes{}));
    store(to + 2 * x + kLanes, by_turns<kLanes / 2>(even, odd, Lanes{}));
  }
}

/// Adds a row of colour and transmittance behind a row of the tile.
void add_behind(const float (*from)[kDiscTileRow], int width, int y, DiscTile& tile) {
  for (int x = 0; x < width; x += kLanes) {
    const Floats open = load(tile.channel[kDiscTransmitted][y] + x);
    for (int i = 0; i < 3; ++i) {
      float* to = tile.channel[i][y] + x;
      store(to, load(to) + open * load(from[i] + x));
    }
    store(tile.channel[kDiscTransmitted][y] + x, open * load(from[kDiscTransmitted] + x));
  }
}

/// Divides by the opacity reached, and stores the tile with the scene's depth. Rows are
/// `scene_row` and `row` halves apart.
void store_disc_tile(const DiscTile& tile, const std::uint16_t* scene, std::ptrdiff_t scene_row,
                     int width, int height, HalfRounding rounding, std::uint16_t* to,
                     std::ptrdiff_t row) {
  if (rounding == HalfRounding::nearest_even) {
    store_tile<HalfRounding::nearest_even>(tile, scene, scene_row, width, height, to, row);
  } else {
    store_tile<HalfRounding::toward_zero>(tile, scene, scene_row, width, height, to, row);
  }
  finish_streaming();
}

#endif

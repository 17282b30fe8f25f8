#include "dof/disc_layers/disc_layers.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#include "dof/disc_layers/disc_blur.h"
#include "dof/disc_layers/disc_highlights.h"
#include "dof/disc_layers/disc_levels.h"
#include "dof/disc_layers/lit_discs.h"
#include "raster/threads/scratch_shelf.h"

namespace softfocus {
namespace {

struct Workspace {
  DiscTile tile;
  DiscScratch scratch;
  // Level 0: colours and signed squares of what is seen, then of what is hidden.
  alignas(kRowAlignment) float picture[kDiscTileRows][4][kDiscTileRow];
  float hidden[kDiscTileRows][4][kDiscTileRow];
  float ones[kDiscTileRow];
  float gain[kDiscTileHeight][kDiscTileWidth];
  bool any_hidden;
  bool row_hidden[kDiscTileRows];  // whether `hidden` has a row; if not, it is that of `picture`
  LitTile lit;
  LitSums lit_sums;
};

struct Frame {
  const DofInput& input;
  const HiddenPicture& hidden;
  const std::vector<LevelRungs>& ladder;
  std::vector<DiscLevel>& levels;
  const DiscHighlights& highlights;
  LitGains& gains;
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

// The strip of a tile's row that begins x pixels from the tile on. The edges repeat outwards.
int strip_at(const HiddenPicture& hidden, int tile_x, int x) {
  return std::clamp((tile_x + x) / kHiddenStrip, 0, hidden.strip_columns - 1);
}

// Splits a strip of what near things hide into a tile's row, as far as it lies in the row.
void split_hidden_strip(const DofInput& behind, int tile_x, int x, int y,
                        float (&to)[4][kDiscTileRow], Isa isa) {
  const int begin = std::max(x, -kDiscMargin);
  const int end = std::min(x + kHiddenStrip, kDiscTileWidth + kDiscMargin);
  if (end - begin == kHiddenStrip) {
    split_disc_row(behind, tile_x + x, y, kHiddenStrip, to[0] + kDiscMargin + x, kDiscTileRow, isa);
    return;
  }
  float strip[4][kHiddenStrip];
  split_disc_row(behind, tile_x + x, y, kHiddenStrip, strip[0], kHiddenStrip, isa);
  for (int i = 0; i < 4; ++i) {
    std::copy(strip[i] + (begin - x), strip[i] + (end - x), to[i] + kDiscMargin + begin);
  }
}

// A row of a tile in what near things hide: strips that have none are the picture's. Returns
// whether any strip has some.
bool split_hidden_row(const DofInput& behind, const HiddenPicture& hidden, int tile_x, int y,
                      int y_ahead, const float (&picture)[4][kDiscTileRow],
                      float (&to)[4][kDiscTileRow], Isa isa) {
  static_assert(kDiscMargin < kHiddenStrip && kDiscTileWidth % kHiddenStrip == 0);
  bool any = false;
  for (int x = -kHiddenStrip; x < kDiscTileWidth + kDiscMargin; x += kHiddenStrip) {
    const int strip = strip_at(hidden, tile_x, x);
    if (hidden.strip(strip, y_ahead)) {
      fetch_texels(hidden.picture, strip * kHiddenStrip, y_ahead, kHiddenStrip);
    }
    if (!hidden.strip(strip, y)) continue;
    if (!any) std::memcpy(to, picture, sizeof to);
    any = true;
    split_hidden_strip(behind, tile_x, x, y, to, isa);
  }
  return any;
}

// Splits a tile's part of the picture, with `apron` more rows above and below.
void split_tile(const Frame& frame, const Rectangle& at, int apron, Workspace& work) {
  constexpr int kAhead = 4;  // rows
  const int last = frame.levels[0].height - 1;
  DofInput behind = frame.input;
  if (work.any_hidden) behind.scene = frame.hidden.picture;
  for (int y = -apron; y < at.height + apron; ++y) {
    const int inside = std::clamp(at.y + y, 0, last), row = y + kDiscApron;
    const int ahead = std::min(inside + kAhead, last);
    fetch_texels(frame.input.scene, at.x - kDiscMargin, ahead, kDiscTileRow);
    split_disc_row(frame.input, at.x - kDiscMargin, inside, kDiscTileRow, work.picture[row][0],
                   kDiscTileRow, frame.isa);
    work.row_hidden[row] =
        work.any_hidden && split_hidden_row(behind, frame.hidden, at.x, inside, ahead,
                                            work.picture[row], work.hidden[row], frame.isa);
  }
}

DiscRow split_row(const float (&row)[4][kDiscTileRow], const Workspace& work) {
  return {{row[0] + kDiscMargin, row[1] + kDiscMargin, row[2] + kDiscMargin,
           work.ones + kDiscMargin, row[3] + kDiscMargin}};
}

// The range of a tile that blocks with a rung reach, in pixels from the tile's first.
struct Reached {
  int begin, end;
};
Reached reached_by(const std::uint32_t* blocks, int first, int count, std::size_t number, int reach,
                   int at, int size) {
  Reached range{size, 0};
  for (int i = 0; i < count; ++i) {
    if ((blocks[i] >> number & 1u) == 0) continue;
    const int block = (first + i) * kDiscBlock - at;
    range.begin = std::min(range.begin, std::max(block - reach, 0));
    range.end = std::max(range.end, std::min(block + kDiscBlock + reach, size));
  }
  return range;
}

DiscPart whole_of(const Rectangle& at) { return {0, at.height, 0, kWholeTile.columns}; }

// The part of a tile that a rung's discs reach.
DiscPart part_reached(const Rung& rung, std::size_t number, const DiscRungBlocks& near,
                      const Rectangle& at) {
  const int reach = rung.spans[0].whole + 1;
  const Reached rows = reached_by(near.of_row, near.row, near.rows, number, reach, at.y, at.height);
  const Reached columns =
      reached_by(near.of_column, near.column, near.columns, number, reach, at.x, at.width);
  if (rows.begin >= rows.end || columns.begin >= columns.end) return {0, 0, 0, 0};
  const int first = columns.begin / kDiscColumn;
  return {rows.begin, rows.end - rows.begin, first, (columns.end - 1) / kDiscColumn + 1 - first};
}

// Sums a rung's discs in a part of a tile.
void blur_rung(const Frame& frame, std::size_t level, DiscSide side, std::size_t number,
               const Rectangle& at, const DiscPart& part, Workspace& work) {
  const LevelRungs& rungs = frame.ladder[level];
  const Rung& rung = rungs.rungs[number];
  const DiscLevel& picture = frame.levels[level];
  const int reach = static_cast<int>(rung.spans.size()) - 1;
  const bool hidden = level == 0 && work.any_hidden;
  DiscRow rows[kDiscTileRows], hidden_rows[kDiscTileRows];
  for (int y = 0; y < part.rows + 2 * (reach + 1); ++y) {
    if (level == 0) {
      const int row = part.row + y + kDiscApron - reach - 1;
      rows[y] = split_row(work.picture[row], work);
      if (hidden) {
        hidden_rows[y] =
            split_row(work.row_hidden[row] ? work.hidden[row] : work.picture[row], work);
      }
    } else {
      rows[y] =
          disc_row(picture, side == DiscSide::near ? 0 : 1, at.x, at.y + part.row + y - reach - 1);
    }
  }
  const bool last = number + 1 == rungs.rungs.size();
  const bool near = side == DiscSide::near;
  const DiscBlur blur{hidden && !near ? hidden_rows : rows,
                      part,
                      side,
                      level == 0 && near ? -1.0f : 1.0f,
                      rung.step,
                      last ? rungs.beyond : rungs.rungs[number + 1].step,
                      rung.spans.data(),
                      reach,
                      rung.area,
                      hidden && near ? hidden_rows : nullptr};
  blur_disc_tile(blur, work.scratch, frame.isa);
}

// A tile's place in the next level, with the pixels around it that enlarging needs.
Rectangle in_next_level(const Rectangle& at) {
  return {at.x / 2 - 1, at.y / 2 - 1, at.width / 2 + 2, at.height / 2 + 2};
}

bool is_lit(const LitRung& rung, std::size_t level, const Rectangle& at) {
  return lit_near(rung, level, at.x, at.y, at.width, at.height);
}

// Whether a level or a larger one has anything of that side to show in a rectangle.
bool any_seen(const Frame& frame, std::size_t level, int side, const Rectangle& at) {
  if (level == frame.levels.size()) return false;
  if (rungs_near(frame.levels[level], side, at.x, at.y, at.width, at.height) != 0) return true;
  return any_seen(frame, level + 1, side, in_next_level(at));
}

// Whether it has any highlights there.
bool any_lit(const Frame& frame, std::size_t level, int side, const Rectangle& at) {
  for (const LitRung& rung : frame.highlights.rungs) {
    if (rung.side == side && rung.level >= level && is_lit(rung, level, at)) return true;
  }
  return false;
}

// A level's rungs that have highlights there, a bit each.
std::uint32_t lit_rungs(const Frame& frame, std::size_t level, int side, const Rectangle& at) {
  std::uint32_t rungs = 0;
  for (const LitRung& rung : frame.highlights.rungs) {
    if (rung.side != side || rung.level != level || !is_lit(rung, level, at)) continue;
    rungs |= 1u << rung.number;
  }
  return rungs;
}

// Enlarges a row of planes of the next level to a tile's pixels.
void enlarge_row(const Frame& frame, const DiscPlanes& from, int plane, int rows,
                 const Rectangle& at, int row, float* to) {
  const int y = at.y + row;
  const int inside = y / 2;
  const int other = std::clamp(y % 2 == 0 ? inside - 1 : inside + 1, 0, rows - 1);
  enlarge_disc_row(plane_row(from, plane, inside) + kDiscMargin + at.x / 2,
                   plane_row(from, plane, other) + kDiscMargin + at.x / 2, at.width + at.width % 2,
                   to, frame.isa);
}

// Enlarges what is seen of the next level's side.
void enlarge(const Frame& frame, std::size_t level, int side, const Rectangle& at, bool behind,
             DiscTile& tile) {
  const DiscLevel& from = frame.levels[level + 1];
  enlarge_disc_tile(from.seen[side], from.height, at.x, at.y, at.height, behind, tile, frame.isa);
}

void start_tile(const Frame& frame, std::size_t level, const Rectangle& at, bool before_focus,
                Workspace& work) {
  if (before_focus && any_seen(frame, level + 1, 0, in_next_level(at))) {
    enlarge(frame, level, 0, at, false, work.tile);
    return;
  }
  const int count = at.height * kDiscTileWidth;
  for (int i = 0; i < 3; ++i) std::fill_n(work.tile.channel[i][0], count, 0.0f);
  std::fill_n(work.tile.channel[kDiscTransmitted][0], count, 1.0f);
}

void add_larger_behind(const Frame& frame, std::size_t level, const Rectangle& at,
                       Workspace& work) {
  if (!any_seen(frame, level + 1, 1, in_next_level(at))) return;
  enlarge(frame, level, 1, at, true, work.tile);
}

// Copies a tile's row into a plane, which repeats its ends outwards.
void keep_row(const DiscLevel& level, const DiscPlanes& planes, int plane, const Rectangle& at,
              int y, const float* from) {
  float* to = plane_row(planes, plane, at.y + y) + kDiscMargin + at.x;
  std::copy_n(from, at.width, to);
  if (at.x == 0) to[-1] = to[0];
  if (at.x + at.width == level.width) to[at.width] = to[at.width - 1];
}

void keep_tile(const DiscLevel& level, int side, const Rectangle& at, const DiscTile& tile) {
  for (int y = 0; y < at.height; ++y) {
    for (int i = 0; i < 4; ++i) keep_row(level, level.seen[side], i, at, y, tile.channel[i][y]);
  }
}

// Draws a rung's highlights in level 0. In other levels keeps the gain for the level before.
void use_gain(const Frame& frame, std::size_t level, std::size_t lit, const Rectangle& at,
              Workspace& work) {
  if (level == 0) {
    add_highlights(frame.highlights, frame.highlights.rungs[lit], at.x, at.y, at.width, at.height,
                   work.gain, work.lit_sums, work.lit, frame.isa);
    return;
  }
  for (int y = 0; y < at.height; ++y) {
    keep_row(frame.levels[level], frame.gains.planes[lit][level - 1], 0, at, y, work.gain[y]);
  }
}

// The gains of larger levels' highlights, as far as `around` has any.
void add_larger_gains(const Frame& frame, std::size_t level, int side, const Rectangle& at,
                      const Rectangle& around, Workspace& work) {
  for (std::size_t i = 0; i < frame.highlights.rungs.size(); ++i) {
    const LitRung& rung = frame.highlights.rungs[i];
    if (rung.side != side || rung.level <= level || !is_lit(rung, level, around)) continue;
    const bool any = is_lit(rung, level + 1, in_next_level(at));
    for (int y = 0; y < at.height; ++y) {
      float* gain = work.gain[y];
      if (!any) {
        std::fill_n(gain, kDiscTileWidth, 0.0f);
        continue;
      }
      enlarge_row(frame, frame.gains.planes[i][level], 0, frame.levels[level + 1].height, at, y,
                  gain);
      if (side == 0) continue;
      const float* open = work.tile.channel[kDiscTransmitted][y];
      for (int x = 0; x < at.width; ++x) {
        gain[x] = std::min(open[x] * gain[x], most_gain(level, side));
      }
    }
    use_gain(frame, level, i, at, work);
  }
}

// The gain of a rung of this level. Needs its sums, not added yet.
void add_own_gain(const Frame& frame, std::size_t level, int side, std::size_t number,
                  const Rectangle& at, Workspace& work) {
  for (std::size_t i = 0; i < frame.highlights.rungs.size(); ++i) {
    const LitRung& rung = frame.highlights.rungs[i];
    if (rung.side != side || rung.level != level || rung.number != number) continue;
    gain_of_disc(work.scratch, work.tile, frame.ladder[level].rungs[number].area,
                 most_gain(level, side), at.width, at.height, work.gain, frame.isa);
    use_gain(frame, level, i, at, work);
  }
}

// Rungs of one side, from the nearest to the farthest.
void blur_side(const Frame& frame, std::size_t level, DiscSide side, const Rectangle& at,
               Workspace& work) {
  const int number = side == DiscSide::near ? 0 : 1;
  const DiscRungBlocks near =
      rung_blocks_near(frame.levels[level], number, at.x, at.y, at.width, at.height);
  const std::uint32_t lit = lit_rungs(frame, level, number, at);
  const std::vector<Rung>& rungs = frame.ladder[level].rungs;
  const std::size_t least = level == 0 ? 1 : 0, end = rungs.size();
  for (std::size_t step = least; step < end; ++step) {
    const std::size_t i = side == DiscSide::near ? end - 1 - (step - least) : step;
    const bool is_lit = (lit >> i & 1u) != 0;
    const DiscPart part = is_lit ? whole_of(at) : part_reached(rungs[i], i, near, at);
    if (part.rows == 0) continue;
    blur_rung(frame, level, side, i, at, part, work);
    if (is_lit) add_own_gain(frame, level, number, i, at, work);
    add_disc_sums(work.scratch, part, work.tile, frame.isa);
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

// Gains of 0 in a tile, for rungs that are lit around it but not in it.
void clear_gains(const Frame& frame, std::size_t level, int side, const Rectangle& at,
                 const Rectangle& around, Workspace& work) {
  for (std::size_t i = 0; i < frame.highlights.rungs.size(); ++i) {
    const LitRung& rung = frame.highlights.rungs[i];
    if (rung.side != side || rung.level != level || !is_lit(rung, level, around)) continue;
    for (int y = 0; y < at.height; ++y) std::fill_n(work.gain[y], kDiscTileWidth, 0.0f);
    use_gain(frame, level, i, at, work);
  }
}

void see_level(const Frame& frame, std::size_t number, ThreadPool& pool) {
  const DiscLevel& level = frame.levels[number];
  for_each_tile(level, pool, [&](const Rectangle& at, Workspace& work) {
    // Leaves out tiles that the level before does not read: its tiles read half their size and
    // two pixels more, if there is anything in them.
    constexpr int kAcross = kDiscTileWidth / 2 + 2, kDown = kDiscTileHeight / 2 + 2;
    const Rectangle around{at.x - kAcross, at.y - kDown, at.width + 2 * kAcross,
                           at.height + 2 * kDown};
    for (int side = 0; side < 2; ++side) {
      if (!any_seen(frame, number, side, around) && !any_lit(frame, number, side, around)) continue;
      start_tile(frame, number, at, side == 0, work);
      clear_gains(frame, number, side, at, around, work);
      if (side == 0) add_larger_gains(frame, number, side, at, around, work);
      blur_side(frame, number, side == 0 ? DiscSide::near : DiscSide::far, at, work);
      if (side == 1) add_larger_gains(frame, number, side, at, around, work);
      if (side == 1) add_larger_behind(frame, number, at, work);
      keep_tile(level, side, at, work.tile);
    }
  });
}

void see_tile(const Frame& frame, const Rectangle& at, Workspace& work) {
  const DiscLevel& level = frame.levels[0];
  const std::uint32_t near = rungs_near(level, 0, at.x, at.y, at.width, at.height);
  const std::uint32_t far = rungs_near(level, 1, at.x, at.y, at.width, at.height);
  const std::uint32_t all = near | far | lit_rungs(frame, 0, 0, at) | lit_rungs(frame, 0, 1, at);
  work.any_hidden = hidden_near(frame.hidden, at.x, at.y, at.width, at.height);
  // Beyond the last rung of level 0 nothing reads the tile's part of the picture.
  if ((all & ((1u << frame.ladder[0].rungs.size()) - 1)) != 0) {
    split_tile(frame, at, reach_of(frame.ladder[0], all) + 1, work);
  }
  start_tile(frame, 0, at, true, work);
  add_larger_gains(frame, 0, 0, at, at, work);
  blur_side(frame, 0, DiscSide::near, at, work);
  if (((near | far) & 1u) != 0) {
    blur_rung(frame, 0, DiscSide::focus, 0, at, whole_of(at), work);
    add_disc_sums(work.scratch, whole_of(at), work.tile, frame.isa);
  }
  blur_side(frame, 0, DiscSide::far, at, work);
  add_larger_gains(frame, 0, 1, at, at, work);
  add_larger_behind(frame, 0, at, work);
}

}  // namespace

std::vector<LevelRungs> disc_ladder_of(const DofInput& input) {
  return make_ladder(input.settings.max_coc_px);
}

void disc_layers(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  blur_discs(input, result, pool, find_hidden);
}

void blur_discs(const DofInput& input, const ImageView& result, ThreadPool& pool, FindHidden find) {
  if (pool.isa() == Isa::scalar) return blur_discs_oracle(input, result, pool, find);
  const std::vector<LevelRungs> ladder = disc_ladder_of(input);
  const DiscHighlights highlights = find_highlights(input, ladder, pool);
  DofInput rest = input;
  if (highlights.rest.width != 0) rest.scene = highlights.rest;
  const HiddenPicture hidden = find(rest, pool);
  DiscLevels made = make_disc_levels(rest, hidden, ladder, pool);
  std::vector<DiscLevel>& levels = made.levels;
  LitGains gains = make_gains(highlights, levels);
  const Frame frame{rest, hidden, ladder, levels, highlights, gains, pool.isa()};
  for (std::size_t i = levels.size(); i-- > 1;) see_level(frame, i, pool);
  for_each_tile(levels[0], pool, [&](const Rectangle& at, Workspace& work) {
    const bool lit = any_lit(frame, 0, 0, at) || any_lit(frame, 0, 1, at);
    if (lit) std::memset(&work.lit, 0, sizeof work.lit);
    see_tile(frame, at, work);
    store_disc_tile(work.tile, lit ? &work.lit : nullptr,
                    row<std::uint16_t>(input.scene, at.y).data() + 4 * at.x,
                    input.scene.stride_bytes / 2, at.width, at.height, input.profile.half_store,
                    row<std::uint16_t>(result, at.y).data() + 4 * at.x, result.stride_bytes / 2,
                    frame.isa);
  });
}

}  // namespace softfocus

#include "dof/disc_layers/disc_layers.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <span>
#include <vector>

#include "dof/disc_layers/disc_blur.h"
#include "dof/disc_layers/disc_highlights.h"
#include "dof/disc_layers/disc_levels.h"
#include "dof/disc_layers/disc_slopes.h"
#include "dof/disc_layers/lit_discs.h"
#include "dof/level_stack.h"

namespace softfocus {
namespace {

struct DiscWorkspace {
  SeenTile tile;
  DiscScratch scratch;
  // Level 0: colours and signed squares of what is seen, then of what is hidden.
  alignas(kRowAlignment) float picture[kDiscTileRows][4][kDiscTileRow];
  float hidden[kDiscTileRows][4][kDiscTileRow];
  float gain[kLevelTileHeight][kLevelTileWidth];
  bool any_hidden;
  bool row_hidden[kDiscTileRows];  // whether `hidden` has a row; if not, it is that of `picture`
  LitTile lit;
  LitSums lit_sums;
};

struct DiscFrame {
  const DofInput& input;
  const HiddenPicture& hidden;
  const std::vector<LevelRungs>& ladder;
  std::span<const DiscLevel> levels;
  const DiscHighlights& highlights;
  LitGains& gains;
  Isa isa;

  bool any_near(std::size_t level, int side, const LevelRectangle& at) const {
    return rungs_near(levels[level], side, at.x, at.y, at.width, at.height) != 0;
  }
  bool any_wanted(std::size_t level, int side, const LevelRectangle& at) const {
    return any_seen(*this, level, side, at) || any_lit(level, side, at);
  }
  // Whether a level or a larger one has highlights there.
  bool any_lit(std::size_t level, int side, const LevelRectangle& at) const;
};

constexpr auto kOnes = [] {
  std::array<float, kDiscTileRow> ones{};
  ones.fill(1.0f);
  return ones;
}();

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
  const int end = std::min(x + kHiddenStrip, kLevelTileWidth + kDiscMargin);
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
  static_assert(kDiscMargin < kHiddenStrip && kLevelTileWidth % kHiddenStrip == 0);
  bool any = false;
  for (int x = -kHiddenStrip; x < kLevelTileWidth + kDiscMargin; x += kHiddenStrip) {
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
void split_tile(const DiscFrame& frame, const LevelRectangle& at, int apron, DiscWorkspace& work) {
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

LevelRow split_row(const float (&row)[4][kDiscTileRow]) {
  return {{row[0] + kDiscMargin, row[1] + kDiscMargin, row[2] + kDiscMargin,
           kOnes.data() + kDiscMargin, row[3] + kDiscMargin}};
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

DiscPart whole_of(const LevelRectangle& at) { return {0, at.height, 0, kWholeTile.columns}; }

// The part of a tile that a rung's discs reach.
DiscPart part_reached(const Rung& rung, std::size_t number, const DiscRungBlocks& near,
                      const LevelRectangle& at) {
  const int reach = rung.spans[0].whole + 1;
  const Reached rows = reached_by(near.of_row, near.row, near.rows, number, reach, at.y, at.height);
  const Reached columns =
      reached_by(near.of_column, near.column, near.columns, number, reach, at.x, at.width);
  if (rows.begin >= rows.end || columns.begin >= columns.end) return {0, 0, 0, 0};
  const int first = columns.begin / kDiscColumn;
  return {rows.begin, rows.end - rows.begin, first, (columns.end - 1) / kDiscColumn + 1 - first};
}

// Sums a rung's discs in a part of a tile.
void blur_rung(const DiscFrame& frame, std::size_t level, DiscSide side, std::size_t number,
               const LevelRectangle& at, const DiscPart& part, DiscWorkspace& work) {
  const LevelRungs& rungs = frame.ladder[level];
  const Rung& rung = rungs.rungs[number];
  const DiscLevel& picture = frame.levels[level];
  const int reach = static_cast<int>(rung.spans.size()) - 1;
  const bool hidden = level == 0 && work.any_hidden;
  LevelRow rows[kDiscTileRows], hidden_rows[kDiscTileRows];
  for (int y = 0; y < part.rows + 2 * (reach + 1); ++y) {
    if (level == 0) {
      const int row = part.row + y + kDiscApron - reach - 1;
      rows[y] = split_row(work.picture[row]);
      if (hidden) {
        hidden_rows[y] = split_row(work.row_hidden[row] ? work.hidden[row] : work.picture[row]);
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

bool is_lit(const LitRung& rung, std::size_t level, const LevelRectangle& at) {
  return lit_near(rung, level, at.x, at.y, at.width, at.height);
}

bool DiscFrame::any_lit(std::size_t level, int side, const LevelRectangle& at) const {
  for (const LitRung& rung : highlights.rungs) {
    if (rung.side == side && rung.level >= level && is_lit(rung, level, at)) return true;
  }
  return false;
}

// A level's rungs that have highlights there, a bit each.
std::uint32_t lit_rungs(const DiscFrame& frame, std::size_t level, int side,
                        const LevelRectangle& at) {
  std::uint32_t rungs = 0;
  for (const LitRung& rung : frame.highlights.rungs) {
    if (rung.side != side || rung.level != level || !is_lit(rung, level, at)) continue;
    rungs |= 1u << rung.number;
  }
  return rungs;
}

// Enlarges a row of a plane of the next level to a tile's pixels.
void enlarge_row(const LevelPlanes& from, int rows, const LevelRectangle& at, int row, float* to,
                 Isa isa) {
  const int y = at.y + row;
  const int inside = y / 2;
  const int other = std::clamp(y % 2 == 0 ? inside - 1 : inside + 1, 0, rows - 1);
  enlarge_disc_row(plane_row(from, 0, inside) + at.x / 2, plane_row(from, 0, other) + at.x / 2,
                   at.width + at.width % 2, to, isa);
}

// Draws a rung's highlights in level 0. In other levels keeps the gain for the level before.
void use_gain(const DiscFrame& frame, std::size_t level, std::size_t lit, const LevelRectangle& at,
              DiscWorkspace& work) {
  if (level == 0) {
    add_highlights(frame.highlights, frame.highlights.rungs[lit], at.x, at.y, at.width, at.height,
                   work.gain, work.lit_sums, work.lit, frame.isa);
    return;
  }
  for (int y = 0; y < at.height; ++y) {
    keep_row(frame.gains.planes[lit][level - 1], frame.levels[level].width, 0, at, y, work.gain[y]);
  }
}

// The gains of larger levels' highlights, as far as `around` has any.
void add_larger_gains(const DiscFrame& frame, std::size_t level, int side, const LevelRectangle& at,
                      const LevelRectangle& around, DiscWorkspace& work) {
  for (std::size_t i = 0; i < frame.highlights.rungs.size(); ++i) {
    const LitRung& rung = frame.highlights.rungs[i];
    if (rung.side != side || rung.level <= level || !is_lit(rung, level, around)) continue;
    const bool any = is_lit(rung, level + 1, in_next_level(at));
    for (int y = 0; y < at.height; ++y) {
      float* gain = work.gain[y];
      if (!any) {
        std::fill_n(gain, kLevelTileWidth, 0.0f);
        continue;
      }
      enlarge_row(frame.gains.planes[i][level], frame.levels[level + 1].height, at, y, gain,
                  frame.isa);
      if (side == 0) continue;
      const float* open = work.tile.channel[kTransmitted][y];
      for (int x = 0; x < at.width; ++x) {
        gain[x] = std::min(open[x] * gain[x], most_gain(level, side));
      }
    }
    use_gain(frame, level, i, at, work);
  }
}

// The gain of a rung of this level. Needs its sums, not added yet.
void add_own_gain(const DiscFrame& frame, std::size_t level, int side, std::size_t number,
                  const LevelRectangle& at, DiscWorkspace& work) {
  for (std::size_t i = 0; i < frame.highlights.rungs.size(); ++i) {
    const LitRung& rung = frame.highlights.rungs[i];
    if (rung.side != side || rung.level != level || rung.number != number) continue;
    gain_of_disc(work.scratch, work.tile, frame.ladder[level].rungs[number].area,
                 most_gain(level, side), at.width, at.height, work.gain, frame.isa);
    use_gain(frame, level, i, at, work);
  }
}

// Rungs of one side, from the nearest to the farthest.
void blur_side(const DiscFrame& frame, std::size_t level, DiscSide side, const LevelRectangle& at,
               DiscWorkspace& work) {
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

// Gains of 0 in a tile, for rungs that are lit around it but not in it.
void clear_gains(const DiscFrame& frame, std::size_t level, int side, const LevelRectangle& at,
                 const LevelRectangle& around, DiscWorkspace& work) {
  for (std::size_t i = 0; i < frame.highlights.rungs.size(); ++i) {
    const LitRung& rung = frame.highlights.rungs[i];
    if (rung.side != side || rung.level != level || !is_lit(rung, level, around)) continue;
    for (int y = 0; y < at.height; ++y) std::fill_n(work.gain[y], kLevelTileWidth, 0.0f);
    use_gain(frame, level, i, at, work);
  }
}

// Lays a side's rungs behind what is seen of larger levels before the focus.
void see_side(const DiscFrame& frame, std::size_t level, int side, const LevelRectangle& at,
              DiscWorkspace& work) {
  const LevelRectangle around = around_tile(at);
  clear_gains(frame, level, side, at, around, work);
  if (side == 0) add_larger_gains(frame, level, side, at, around, work);
  blur_side(frame, level, side == 0 ? DiscSide::near : DiscSide::far, at, work);
  if (side == 1) add_larger_gains(frame, level, side, at, around, work);
}

void see_tile(const DiscFrame& frame, const LevelRectangle& at, DiscWorkspace& work) {
  const DiscLevel& level = frame.levels[0];
  const std::uint32_t near = rungs_near(level, 0, at.x, at.y, at.width, at.height);
  const std::uint32_t far = rungs_near(level, 1, at.x, at.y, at.width, at.height);
  const std::uint32_t all = near | far | lit_rungs(frame, 0, 0, at) | lit_rungs(frame, 0, 1, at);
  work.any_hidden = hidden_near(frame.hidden, at.x, at.y, at.width, at.height);
  // Beyond the last rung of level 0 nothing reads the tile's part of the picture.
  if ((all & ((1u << frame.ladder[0].rungs.size()) - 1)) != 0) {
    split_tile(frame, at, reach_of(frame.ladder[0], all) + 1, work);
  }
  start_tile(frame, 0, 0, at, work.tile);
  add_larger_gains(frame, 0, 0, at, at, work);
  blur_side(frame, 0, DiscSide::near, at, work);
  if (((near | far) & 1u) != 0) {
    blur_rung(frame, 0, DiscSide::focus, 0, at, whole_of(at), work);
    add_disc_sums(work.scratch, whole_of(at), work.tile, frame.isa);
  }
  blur_side(frame, 0, DiscSide::far, at, work);
  add_larger_gains(frame, 0, 1, at, at, work);
  add_larger_behind(frame, 0, at, work.tile);
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
  const CentredDiscs centred = centre_discs(rest, pool);
  rest.scene = centred.picture;
  const HiddenPicture hidden = find(rest, pool);
  const DiscLevels made = make_disc_levels(rest, hidden, ladder, pool);
  LitGains gains = make_gains(highlights, made.levels, pool.memory());
  const DiscFrame frame{rest, hidden, ladder, made.levels, highlights, gains, pool.isa()};
  see_levels<DiscWorkspace>(
      frame, pool, [&](std::size_t level, int side, const LevelRectangle& at, DiscWorkspace& work) {
        see_side(frame, level, side, at, work);
      });
  for_each_tile<DiscWorkspace>(
      frame.levels[0], pool, [&](const LevelRectangle& at, DiscWorkspace& work) {
        const bool lit = frame.any_lit(0, 0, at) || frame.any_lit(0, 1, at);
        if (lit) std::memset(&work.lit, 0, sizeof work.lit);
        see_tile(frame, at, work);
        store_tile(input, result, at, work.tile, lit ? &work.lit : nullptr, frame.isa);
      });
}

}  // namespace softfocus

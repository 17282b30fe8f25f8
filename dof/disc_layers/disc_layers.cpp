#include "dof/disc_layers/disc_layers.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "dof/disc_layers/disc_levels.h"
#include "raster/threads/scratch_shelf.h"

#define SOFTFOCUS_KERNELS "dof/disc_layers/disc_layers_kernels.inl"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

struct Workspace {
  DiscTile tile;
  DiscScratch scratch;
  float picture[kDiscTileRows][4][kDiscTileRow];  // of level 0: colours and signed squares
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

// The farthest that discs of some rungs reach.
int reach_of(const LevelRungs& level, std::uint32_t rungs) {
  std::size_t reach = 1;
  for (std::size_t i = 0; i < level.rungs.size(); ++i) {
    if ((rungs >> i & 1u) != 0) reach = std::max(reach, level.rungs[i].spans.size());
  }
  return static_cast<int>(reach) - 1;
}

// The tile's part of the picture, for discs of any reach.
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

// Where a tile lies in the next level, and the pixels around it that enlarging takes.
Rectangle in_next_level(const Rectangle& at) {
  return {at.x / 2 - 1, at.y / 2 - 1, at.width / 2 + 2, at.height / 2 + 2};
}

// Whether a level or a larger one has anything of that side to show in a rectangle.
bool any_seen(const Frame& frame, std::size_t level, int side, const Rectangle& at) {
  if (level == frame.levels.size()) return false;
  if (rungs_near(frame.levels[level], side, at.x, at.y, at.width, at.height) != 0) return true;
  return any_seen(frame, level + 1, side, in_next_level(at));
}

// A row of what is seen of the next level, in pixels of a tile's.
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
    // Tiles that nobody asks for are left out: a tile of the smaller level asks for half its
    // size, and two pixels, if there is anything in them.
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
  if (pool.isa() == Isa::scalar) return disc_layers_plain(input, result, pool);
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

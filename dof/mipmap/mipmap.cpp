#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "dof/mipmap/mipmap.h"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "dof/mipmap/mip_levels.h"
#include "dof/picture_planes.h"
#include "raster/threads/scratch_shelf.h"

namespace softfocus {

constexpr int kMipTileRows = kMipTileHeight + 2 * kMipReach;

// A row of a side from the tile's first pixel on. Without weights all are 1.
struct MipRow {
  const float* channel[kMipChannels];
};

// A rung to blur in a tile.
struct MipBlur {
  const MipRow* rows;  // the first lies kMipReach rows above the tile
  int width, height;
  bool near;
  MipStep begin, end;
  const MipRung* rung;
};

// A tile's rungs so far: colour and transmittance.
struct MipTile {
  float channel[kSeenChannels][kMipTileHeight][kMipTileWidth];
};

// Memory to blur a rung in: colours times share, share, and the share of the rung and of all that
// it hides.
struct MipScratch {
  float products[kMipChannels][kMipTileRows][kMipTileRow];
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "dof/mipmap/mipmap.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

struct Workspace {
  MipTile tile;
  MipScratch scratch;
  MipPictureRow picture[kMipTileRows];
  float enlarged[kSeenChannels][kMipTileRow];
};

struct Frame {
  const DofInput& input;
  const std::vector<MipLevelRungs>& ladder;
  const MipPyramid& pyramid;
  Isa isa;
};

struct Rectangle {
  int x, y, width, height;
};

unsigned rungs_near(const Frame& frame, std::size_t level, MipSide side, const Rectangle& at) {
  if (side == MipSide::near && !frame.pyramid.any_near) return 0;
  // The last bit stands for what lies beyond.
  const unsigned rungs = (1u << frame.ladder[level].rungs.size()) - 1;
  return rungs_near(frame.pyramid.levels[level], side, at.x, at.y, at.width, at.height) & rungs;
}

// A tile's place in the next level, with the pixels around it that enlarging needs.
Rectangle in_next_level(const Rectangle& at) {
  return {at.x / 2 - 1, at.y / 2 - 1, at.width / 2 + 3, at.height / 2 + 3};
}

// Whether a level or a larger one has anything of that side to show in a rectangle.
bool any_seen(const Frame& frame, std::size_t level, MipSide side, const Rectangle& at) {
  if (level == frame.ladder.size()) return false;
  return rungs_near(frame, level, side, at) != 0 ||
         any_seen(frame, level + 1, side, in_next_level(at));
}

void read_tile(const Frame& frame, const Rectangle& at, Workspace& work) {
  const MipLevel& whole = frame.pyramid.levels[0];
  const MipStep near = frame.ladder[0].rungs[1].step;
  const bool fill =
      frame.pyramid.any_near &&
      (rungs_near(whole, MipSide::near, at.x - kMipMargin, at.y, kMipTileRow, at.height) & ~1u) !=
          0;
  for (int y = -kMipReach; y < at.height + kMipReach; ++y) {
    read_mip_row(frame.input, frame.pyramid, near, at.x - kMipMargin,
                 std::clamp(at.y + y, 0, whole.height - 1), kMipTileRow, fill,
                 work.picture[y + kMipReach], frame.isa);
  }
}

MipRow row_of(const Frame& frame, std::size_t level, MipSide side, const Rectangle& at, int y,
              const Workspace& work) {
  MipRow row{};
  if (level == 0) {
    const MipPictureRow& picture = work.picture[y + kMipReach];
    const float(*const from)[kMipTileRow] = side == MipSide::near ? picture.near : picture.far;
    for (int i = 0; i < 3; ++i) row.channel[i] = from[i] + kMipMargin;
    row.channel[kMipSquare] = from[3] + kMipMargin;
    return row;
  }
  const MipLevel& picture = frame.pyramid.levels[level];
  const int inside = std::clamp(at.y + y, 0, picture.height - 1);
  for (int i = 0; i < kMipChannels; ++i) {
    row.channel[i] = plane_row(picture.sides[static_cast<int>(side)], i, inside) + at.x;
  }
  return row;
}

void blur_rung(const Frame& frame, std::size_t level, MipSide side, std::size_t number,
               const Rectangle& at, Workspace& work) {
  const MipLevelRungs& rungs = frame.ladder[level];
  MipRow rows[kMipTileRows];
  for (int y = -kMipReach; y < at.height + kMipReach; ++y) {
    rows[y + kMipReach] = row_of(frame, level, side, at, y, work);
  }
  const bool last = number + 1 == rungs.rungs.size();
  const MipBlur blur{rows,
                     at.width,
                     at.height,
                     side == MipSide::near,
                     rungs.rungs[number].step,
                     last ? rungs.beyond : rungs.rungs[number + 1].step,
                     &rungs.rungs[number]};
  SOFTFOCUS_KERNEL(frame.isa, multiply_mip_shares)(blur, work.scratch);
  SOFTFOCUS_KERNEL(frame.isa, add_mip_rung)(blur, work.scratch, work.tile);
}

// Enlarges a row of what is seen of the next level to a tile's pixels.
void enlarge(const Frame& frame, std::size_t level, MipSide side, const Rectangle& at, int row,
             float* const (&to)[kSeenChannels]) {
  const MipLevel& from = frame.pyramid.levels[level + 1];
  const MipPlanes& seen = from.seen[static_cast<int>(side)];
  const int y = at.y + row;
  const int inside = y / 2;
  const int other = std::clamp(y % 2 == 0 ? inside - 1 : inside + 1, 0, from.height - 1);
  for (int i = 0; i < kSeenChannels; ++i) {
    SOFTFOCUS_KERNEL(frame.isa, enlarge_mip_row)
    (plane_row(seen, i, inside) + at.x / 2, plane_row(seen, i, other) + at.x / 2,
     at.width + at.width % 2, to[i]);
  }
}

void start_tile(const Frame& frame, std::size_t level, MipSide side, const Rectangle& at,
                Workspace& work) {
  const bool any = side == MipSide::near && any_seen(frame, level + 1, side, in_next_level(at));
  for (std::size_t y = 0; y < static_cast<std::size_t>(at.height); ++y) {
    float* const to[] = {work.tile.channel[0][y], work.tile.channel[1][y], work.tile.channel[2][y],
                         work.tile.channel[3][y]};
    if (any) {
      enlarge(frame, level, side, at, static_cast<int>(y), to);
    } else {
      for (int i = 0; i < 3; ++i) std::fill_n(to[i], kMipTileWidth, 0.0f);
      std::fill_n(to[kMipTransmitted], kMipTileWidth, 1.0f);
    }
  }
}

void blur_near(const Frame& frame, std::size_t level, const Rectangle& at, Workspace& work) {
  const unsigned rungs = rungs_near(frame, level, MipSide::near, at);
  const std::size_t least = level == 0 ? 1 : 0;
  for (std::size_t i = frame.ladder[level].rungs.size(); i-- > least;) {
    if ((rungs >> i & 1u) != 0) blur_rung(frame, level, MipSide::near, i, at, work);
  }
}

void blur_far(const Frame& frame, std::size_t level, const Rectangle& at, Workspace& work) {
  const unsigned rungs = rungs_near(frame, level, MipSide::far, at);
  for (std::size_t i = 0; i < frame.ladder[level].rungs.size(); ++i) {
    if ((rungs >> i & 1u) != 0) blur_rung(frame, level, MipSide::far, i, at, work);
  }
  if (!any_seen(frame, level + 1, MipSide::far, in_next_level(at))) return;
  float* const to[] = {work.enlarged[0], work.enlarged[1], work.enlarged[2], work.enlarged[3]};
  for (int y = 0; y < at.height; ++y) {
    enlarge(frame, level, MipSide::far, at, y, to);
    SOFTFOCUS_KERNEL(frame.isa, add_mip_behind)(work.enlarged, at.width, y, work.tile);
  }
}

template <class Body>
void for_each_tile(const MipLevel& level, ThreadPool& pool, const Body& body) {
  const int columns = (level.width + kMipTileWidth - 1) / kMipTileWidth;
  const int rows = (level.height + kMipTileHeight - 1) / kMipTileHeight;
  ScratchShelf<std::unique_ptr<Workspace>> shelf;
  pool.for_each(columns * rows, [&](int task) {
    std::unique_ptr<Workspace> work = shelf.take();
    if (!work) work = std::make_unique<Workspace>();
    const int x = task % columns * kMipTileWidth, y = task / columns * kMipTileHeight;
    body(Rectangle{x, y, std::min(kMipTileWidth, level.width - x),
                   std::min(kMipTileHeight, level.height - y)},
         *work);
    shelf.put_back(std::move(work));
  });
}

void keep_tile(const MipLevel& level, MipSide side, const Rectangle& at, const MipTile& tile) {
  for (int y = 0; y < at.height; ++y) {
    for (int i = 0; i < kSeenChannels; ++i) {
      float* to = plane_row(level.seen[static_cast<int>(side)], i, at.y + y) + at.x;
      std::copy_n(tile.channel[i][y], at.width, to);
      if (at.x == 0) to[-1] = to[0];
      if (at.x + at.width == level.width) to[at.width] = to[at.width - 1];
    }
  }
}

// Leaves out tiles that the level before does not read: its tiles read half their size and two
// pixels more, if there is anything in them.
void see_level(const Frame& frame, std::size_t number, ThreadPool& pool) {
  const MipLevel& level = frame.pyramid.levels[number];
  for_each_tile(level, pool, [&](const Rectangle& at, Workspace& work) {
    constexpr int kAcross = kMipTileWidth / 2 + 3, kDown = kMipTileHeight / 2 + 3;
    const Rectangle around{at.x - kAcross, at.y - kDown, at.width + 2 * kAcross,
                           at.height + 2 * kDown};
    for (const MipSide side : {MipSide::near, MipSide::far}) {
      if (!any_seen(frame, number, side, around)) continue;
      start_tile(frame, number, side, at, work);
      side == MipSide::near ? blur_near(frame, number, at, work)
                            : blur_far(frame, number, at, work);
      keep_tile(level, side, at, work.tile);
    }
  });
}

}  // namespace

void mipmap(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  if (pool.isa() == Isa::scalar) return mipmap_oracle(input, result, pool);
  const std::vector<MipLevelRungs> ladder = make_mip_ladder(input.settings.max_coc_px);
  const MipPyramid pyramid = make_mip_pyramid(input, ladder, pool);
  const Frame frame{input, ladder, pyramid, pool.isa()};
  for (std::size_t i = ladder.size(); i-- > 1;) see_level(frame, i, pool);
  for_each_tile(pyramid.levels[0], pool, [&](const Rectangle& at, Workspace& work) {
    read_tile(frame, at, work);
    start_tile(frame, 0, MipSide::near, at, work);
    blur_near(frame, 0, at, work);
    blur_far(frame, 0, at, work);
    SOFTFOCUS_KERNEL(pool.isa(), finish_mip_tile)(at.width, at.height, work.tile);
    for (int y = 0; y < at.height; ++y) {
      store_span(input, result, at.x, at.y + y, at.width, work.tile.channel[0][y],
                 work.tile.channel[1][y], work.tile.channel[2][y], pool.isa());
    }
  });
}

}  // namespace softfocus

#else  // kernels

namespace {

#include "dof/mipmap/mip_lanes.inl"

// Rows that mirror each other about a row, added: columns[dy] for those dy away.
SOFTFOCUS_INLINE void add_mirrored_rows(const float* row, int reach, int begin, int end,
                                        float (*columns)[kMipTileRow]) {
  for (int x = begin; x < end; x += kLanes) {
    store(columns[0] + x, load(row + x));
    for (int dy = 1; dy <= reach; ++dy) {
      store(columns[dy] + x, load(row + x - dy * kMipTileRow) + load(row + x + dy * kMipTileRow));
    }
  }
}

// The rung's filter about a pixel. Pixels that mirror each other are added first.
SOFTFOCUS_INLINE Floats filtered(const MipRung& rung, const float (*columns)[kMipTileRow], int x) {
  Floats sum = splat(0.0f);
  for (int dy = 0; dy <= rung.reach; ++dy) {
    const float* at = columns[dy] + x;
    sum = sum + rung.weights[dy][0] * load(at);
    for (int dx = 1; dx <= rung.reach && rung.weights[dy][dx] > 0.0f; ++dx) {
      sum = sum + rung.weights[dy][dx] * (load(at - dx) + load(at + dx));
    }
  }
  return sum;
}

}  // namespace

/// The rung's shares of the pixels in and around a tile.
void multiply_mip_shares(const MipBlur& in, MipScratch& scratch) {
  const int reach = in.rung->reach;
  for (int y = kMipReach - reach; y < in.height + kMipReach + reach; ++y) {
    const MipRow& from = in.rows[y];
    for (int x = -((reach + kLanes - 1) / kLanes * kLanes); x < in.width + reach; x += kLanes) {
      const Floats square = load(from.channel[kMipSquare] + x);
      const Floats begun = share_from(in.begin, square), ended = share_from(in.end, square);
      const Floats share = begun - ended;
      const Floats weight =
          from.channel[kMipWeight] == nullptr ? splat(1.0f) : load(from.channel[kMipWeight] + x);
      float* to = scratch.products[0][y] + kMipMargin + x;
      constexpr std::ptrdiff_t kPlane = static_cast<std::ptrdiff_t>(kMipTileRows) * kMipTileRow;
      for (int i = 0; i < 3; ++i) store(to + i * kPlane, load(from.channel[i] + x) * share);
      store(to + 3 * kPlane, weight * share);
      store(to + 4 * kPlane, in.near ? 1.0f - weight * ended : weight * begun);
    }
  }
}

/// Adds a rung behind what is seen of nearer ones.
void add_mip_rung(const MipBlur& in, const MipScratch& scratch, MipTile& tile) {
  const int reach = in.rung->reach;
  const int begin = kMipMargin - (reach + kLanes - 1) / kLanes * kLanes;
  for (int y = 0; y < in.height; ++y) {
    float columns[kMipReach + 1][kMipTileRow], sums[kMipChannels][kMipTileWidth];
    for (int i = 0; i < kMipChannels; ++i) {
      add_mirrored_rows(scratch.products[i][y + kMipReach], reach, begin,
                        kMipMargin + in.width + reach, columns);
      for (int x = 0; x < in.width; x += kLanes) {
        store(sums[i] + x, filtered(*in.rung, columns, kMipMargin + x));
      }
    }
    for (int x = 0; x < in.width; x += kLanes) {
      const Floats all = load(sums[4] + x);
      const Mask any = all > 0.0f;
      float* through = tile.channel[kMipTransmitted][y] + x;
      const Floats transmitted = load(through);
      const Floats scale = select(any, transmitted / select(any, all, splat(1.0f)), splat(0.0f));
      for (int i = 0; i < 3; ++i) {
        float* to = tile.channel[i][y] + x;
        store(to, load(to) + load(sums[i] + x) * scale);
      }
      store(through, larger(transmitted - load(sums[kMipWeight] + x) * scale, splat(0.0f)));
    }
  }
}

/// Enlarges to a row of `count` pixels, an even number.
void enlarge_mip_row(const float* inside, const float* other, int count, float* to) {
  for (int x = 0; x < count / 2; x += kLanes) {
    const Enlarged pixels = enlarge(inside + x, other + x);
    store(to + 2 * x, pixels.lower);
    store(to + 2 * x + kLanes, pixels.upper);
  }
}

/// Adds a row of colour and transmittance behind a row of the tile.
void add_mip_behind(const float (*from)[kMipTileRow], int width, int y, MipTile& tile) {
  for (int x = 0; x < width; x += kLanes) {
    const Floats open = load(tile.channel[kMipTransmitted][y] + x);
    for (int i = 0; i < 3; ++i) {
      float* to = tile.channel[i][y] + x;
      store(to, load(to) + open * load(from[i] + x));
    }
    store(tile.channel[kMipTransmitted][y] + x, open * load(from[kMipTransmitted] + x));
  }
}

/// Divides by the opacity reached.
void finish_mip_tile(int width, int height, MipTile& tile) {
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; x += kLanes) {
      const Floats scale = 1.0f / (1.0f - load(tile.channel[kMipTransmitted][y] + x));
      for (int i = 0; i < 3; ++i) {
        float* at = tile.channel[i][y] + x;
        store(at, load(at) * scale);
      }
    }
  }
}

#endif

#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "dof/mipmap/mipmap.h"

#include <algorithm>
#include <span>
#include <vector>

#include "dof/level_stack.h"
#include "dof/mipmap/mip_levels.h"

namespace softfocus {

constexpr int kMipTileRows = kLevelTileHeight + 2 * kMipReach;

// A rung to blur in a tile.
struct MipBlur {
  const LevelRow* rows;  // at the tile's first pixel; the first lies kMipReach rows above it
  int width, height;
  bool near;
  RungStep begin, end;
  const MipRung* rung;
};

// Memory to blur a rung in: colours times share, share, and the share of the rung and of all that
// it hides.
struct MipScratch {
  float products[kLevelChannels][kMipTileRows][kMipTileRow];
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "dof/mipmap/mipmap.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

struct MipWorkspace {
  SeenTile tile;
  MipScratch scratch;
  MipPictureRow picture[kMipTileRows];
};

struct MipFrame {
  const DofInput& input;
  const std::vector<MipLevelRungs>& ladder;
  const MipPyramid& pyramid;
  std::span<const MipLevel> levels;  // those of the ladder
  Isa isa;

  unsigned near(std::size_t level, MipSide side, const LevelRectangle& at) const {
    if (side == MipSide::near && !pyramid.any_near) return 0;
    // The last bit stands for what lies beyond.
    const unsigned rungs = (1u << ladder[level].rungs.size()) - 1;
    return rungs_near(levels[level], side, at.x, at.y, at.width, at.height) & rungs;
  }
  bool any_near(std::size_t level, int side, const LevelRectangle& at) const {
    return near(level, static_cast<MipSide>(side), at) != 0;
  }
  bool any_wanted(std::size_t level, int side, const LevelRectangle& at) const {
    return any_seen(*this, level, side, at);
  }
};

void read_tile(const MipFrame& frame, const LevelRectangle& at, MipWorkspace& work) {
  const MipLevel& whole = frame.pyramid.levels[0];
  const RungStep near = frame.ladder[0].rungs[1].step;
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

LevelRow row_of(const MipFrame& frame, std::size_t level, MipSide side, const LevelRectangle& at,
                int y, const MipWorkspace& work) {
  LevelRow row{};
  if (level == 0) {
    const MipPictureRow& picture = work.picture[y + kMipReach];
    const float(*const from)[kMipTileRow] = side == MipSide::near ? picture.near : picture.far;
    for (int i = 0; i < 3; ++i) row.channel[i] = from[i] + kMipMargin;
    row.channel[kLevelSquare] = from[3] + kMipMargin;
    return row;
  }
  const MipLevel& picture = frame.pyramid.levels[level];
  const int inside = std::clamp(at.y + y, 0, picture.height - 1);
  for (int i = 0; i < kLevelChannels; ++i) {
    row.channel[i] = plane_row(picture.sides[static_cast<int>(side)], i, inside) + at.x;
  }
  return row;
}

void blur_rung(const MipFrame& frame, std::size_t level, MipSide side, std::size_t number,
               const LevelRectangle& at, MipWorkspace& work) {
  const MipLevelRungs& rungs = frame.ladder[level];
  LevelRow rows[kMipTileRows];
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

void blur_near(const MipFrame& frame, std::size_t level, const LevelRectangle& at,
               MipWorkspace& work) {
  const unsigned rungs = frame.near(level, MipSide::near, at);
  const std::size_t least = level == 0 ? 1 : 0;
  for (std::size_t i = frame.ladder[level].rungs.size(); i-- > least;) {
    if ((rungs >> i & 1u) != 0) blur_rung(frame, level, MipSide::near, i, at, work);
  }
}

void blur_far(const MipFrame& frame, std::size_t level, const LevelRectangle& at,
              MipWorkspace& work) {
  const unsigned rungs = frame.near(level, MipSide::far, at);
  for (std::size_t i = 0; i < frame.ladder[level].rungs.size(); ++i) {
    if ((rungs >> i & 1u) != 0) blur_rung(frame, level, MipSide::far, i, at, work);
  }
}

}  // namespace

void mipmap(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  if (pool.isa() == Isa::scalar) return mipmap_oracle(input, result, pool);
  const std::vector<MipLevelRungs> ladder = make_mip_ladder(input.settings.max_coc_px);
  const MipPyramid pyramid = make_mip_pyramid(input, ladder, pool);
  const MipFrame frame{input, ladder, pyramid, {pyramid.levels.data(), ladder.size()}, pool.isa()};
  see_levels<MipWorkspace>(
      frame, pool, [&](std::size_t level, int side, const LevelRectangle& at, MipWorkspace& work) {
        (side == 0 ? blur_near : blur_far)(frame, level, at, work);
      });
  for_each_tile<MipWorkspace>(frame.levels[0], pool,
                              [&](const LevelRectangle& at, MipWorkspace& work) {
                                read_tile(frame, at, work);
                                start_tile(frame, 0, 0, at, work.tile);
                                blur_near(frame, 0, at, work);
                                blur_far(frame, 0, at, work);
                                add_larger_behind(frame, 0, at, work.tile);
                                store_tile(input, result, at, work.tile, nullptr, frame.isa);
                              });
}

}  // namespace softfocus

#else  // kernels

namespace {

#include "dof/level_lanes.inl"

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
    const LevelRow& from = in.rows[y];
    for (int x = -((reach + kLanes - 1) / kLanes * kLanes); x < in.width + reach; x += kLanes) {
      const Floats square = load(from.channel[kLevelSquare] + x);
      const Floats begun = share_from(in.begin, square), ended = share_from(in.end, square);
      const Floats share = begun - ended;
      const Floats weight = from.channel[kLevelWeight] == nullptr
                                ? splat(1.0f)
                                : load(from.channel[kLevelWeight] + x);
      float* to = scratch.products[0][y] + kMipMargin + x;
      constexpr std::ptrdiff_t kPlane = static_cast<std::ptrdiff_t>(kMipTileRows) * kMipTileRow;
      for (int i = 0; i < 3; ++i) store(to + i * kPlane, load(from.channel[i] + x) * share);
      store(to + 3 * kPlane, weight * share);
      store(to + 4 * kPlane, in.near ? 1.0f - weight * ended : weight * begun);
    }
  }
}

/// Adds a rung behind what is seen of nearer ones.
void add_mip_rung(const MipBlur& in, const MipScratch& scratch, SeenTile& tile) {
  const int reach = in.rung->reach;
  const int begin = kMipMargin - (reach + kLanes - 1) / kLanes * kLanes;
  for (int y = 0; y < in.height; ++y) {
    float columns[kMipReach + 1][kMipTileRow], sums[kLevelChannels][kLevelTileWidth];
    for (int i = 0; i < kLevelChannels; ++i) {
      add_mirrored_rows(scratch.products[i][y + kMipReach], reach, begin,
                        kMipMargin + in.width + reach, columns);
      for (int x = 0; x < in.width; x += kLanes) {
        store(sums[i] + x, filtered(*in.rung, columns, kMipMargin + x));
      }
    }
    add_layer_row(sums[0], kLevelTileWidth, sums[4], y, 0, in.width, tile);
  }
}

#endif

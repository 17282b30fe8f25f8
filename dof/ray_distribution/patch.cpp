#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "dof/ray_distribution/patch.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>

namespace softfocus {

// Up to so many ways of a row's pixels each is tried with all of them.
constexpr int kFewWays = 4;

// Tiles on their way into the cells of a patch.
struct TilesToDraw {
  const float* pixels;  // the first of each sheet
  std::ptrdiff_t stride, plane;
  int tiles_across;
  const float *row_least, *row_most;
  const std::int32_t *x, *y, *tiles;  // of candidates
  const Landing* landings;
  UnevenRows* uneven;
  int count;
  LensPoint lens;
  float* cells;

  const float* tile(int candidate) const {
    const int tile = tiles[candidate];
    return pixels + tile / tiles_across * kReachTile * stride + tile % tiles_across * kReachTile;
  }
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "dof/ray_distribution/patch.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

// The scalar form of draw_tiles() for a row of a tile.
void draw_row_scalar(const TilesToDraw& draw, const Landing& landing, int row) {
  const float* from = draw.tile(landing.candidate) + row * draw.stride;
  for (int x = 0; x < kReachTile; ++x) {
    const float* pixel = from + x;
    const float* radius = pixel + 3 * draw.plane;
    if (*radius == kNothingBehind) continue;
    const int dx = whole_cells(*radius * draw.lens.u), dy = whole_cells(*radius * draw.lens.v);
    // Whether a cell is left between this pixel's and a neighbour's.
    const auto gap = [&](float other, float axis, int moved, int direction) {
      return std::fabs(other - *radius) <= kSurfaceStep &&
             whole_cells(other * axis) == moved + direction;
    };
    const int left = gap(radius[-1], draw.lens.u, dx, -1);
    const int right = gap(radius[1], draw.lens.u, dx, 1);
    const int up = gap(radius[-draw.stride], draw.lens.v, dy, -1);
    const int down = gap(radius[draw.stride], draw.lens.v, dy, 1);
    const int to_x = draw.x[landing.candidate] + x + dx;
    const int to_y = draw.y[landing.candidate] + row + dy;
    for (int y = std::max(to_y - up, 0); y <= std::min(to_y + down, kPatchRows - 1); ++y) {
      for (int i = std::max(to_x - left, 0); i <= std::min(to_x + right, kPatchColumns - 1); ++i) {
        float* cell = draw.cells + y * kCellStride + kCellMargin + i;
        if (!(*radius < *cell)) continue;
        *cell = *radius;
        for (int c = 0; c < 3; ++c) cell[(c + 1) * kCellPlane] = pixel[c * draw.plane];
      }
    }
  }
}

// The scalar form of draw_tiles().
void draw_tiles_scalar(const TilesToDraw& draw) {
  for (int first = 0, end = 0; first < draw.count; first = end) {
    const int y = draw.y[draw.landings[first].candidate];
    while (end < draw.count && draw.y[draw.landings[end].candidate] == y) ++end;
    for (int row = 0; row < kReachTile; ++row) {
      for (int i = first; i < end; ++i) draw_row_scalar(draw, draw.landings[i], row);
    }
  }
}

// Draws the first `count` landings if they share cells with some blocks.
void draw_landings(const Sheet& sheet, const Candidates& candidates, int count, LensPoint lens,
                   Blocks blocks, Patch& patch, Isa isa) {
  int kept = 0;
  for (int i = 0; i < count; ++i) {
    Landing landing = patch.landings[static_cast<std::size_t>(i)];
    const Blocks wanted = blocks_of(landing) & blocks;
    if (wanted == 0) continue;
    landing.first_row = std::countr_zero(wanted) / kBlocksAcross * kBlock;
    landing.end_row = ((63 - std::countl_zero(wanted)) / kBlocksAcross + 1) * kBlock;
    patch.landings[static_cast<std::size_t>(kept++)] = landing;
  }
  const TilesToDraw draw{sheet.row(0, 0),
                         sheet.pixels.stride,
                         sheet.pixels.plane,
                         sheet.tiles_across,
                         sheet.row_least.data(),
                         sheet.row_most.data(),
                         candidates.x.data(),
                         candidates.y.data(),
                         candidates.tiles.data(),
                         patch.landings.data(),
                         patch.uneven.data(),
                         kept,
                         lens,
                         patch.cells.data()};
  if (isa == Isa::scalar) {
    draw_tiles_scalar(draw);
  } else {
    SOFTFOCUS_KERNEL(isa, draw_tiles)(draw);
  }
}

void add_moved_block(const Sheet& sheet, int block, Patch& patch, Isa isa) {
  std::vector<std::ptrdiff_t>& moved = patch.moved[static_cast<std::size_t>(block)];
  if (moved.empty()) return;
  add_moved(sheet.row(0, 0), sheet.pixels.stride, sheet.pixels.plane, moved.data(),
            static_cast<int>(moved.size()), sum_block(patch.sums.data(), block), isa);
  patch.filled[static_cast<std::size_t>(block)] += static_cast<int>(moved.size());
  moved.clear();
}

// How all that lands in a block moves, and how many of its cells that fills.
struct BlockMove {
  int dx = 0, dy = 0, cells = 0;
};

// Notes the blocks where all moves alike and nothing is empty. The others of `blocks`.
Blocks note_moved(const Sheet& sheet, int count, Blocks blocks, Patch& patch) {
  std::array<BlockMove, kBlocks> moves;
  Blocks others = 0;
  for (int i = 0; i < count; ++i) {
    const Landing& landing = patch.landings[static_cast<std::size_t>(i)];
    const auto candidate = static_cast<std::size_t>(landing.candidate);
    const Blocks lands = blocks_of(landing) & blocks;
    if (!landing.even() ||
        sheet.whole[static_cast<std::size_t>(patch.visible.tiles[candidate])] == 0) {
      others |= lands;
      continue;
    }
    const int dx = landing.x0 - patch.visible.x[candidate];
    const int dy = landing.y0 - patch.visible.y[candidate];
    for_each_block(lands & ~others, [&](int block) {
      BlockMove& move = moves[static_cast<std::size_t>(block)];
      if (move.cells > 0 && (move.dx != dx || move.dy != dy)) others |= Blocks{1} << block;
      const int across = kBlock - std::abs(landing.x0 - block % kBlocksAcross * kBlock);
      const int down = kBlock - std::abs(landing.y0 - block / kBlocksAcross * kBlock);
      move = {dx, dy, move.cells + across * down};
    });
  }
  for_each_block(blocks & ~others, [&](int block) {
    const BlockMove move = moves[static_cast<std::size_t>(block)];
    if (move.cells < kBlock * kBlock) {
      others |= Blocks{1} << block;
      return;
    }
    const int x = patch.x + block % kBlocksAcross * kBlock - move.dx + sheet.before;
    const int y = patch.y + block / kBlocksAcross * kBlock - move.dy + sheet.before;
    patch.moved[static_cast<std::size_t>(block)].push_back(y * sheet.pixels.stride + x);
  });
  return others;
}

}  // namespace

Blocks begin_patch(const Sheet& visible, const Sheet& hidden, int x, int y, Patch& patch) {
  patch.x = x;
  patch.y = y;
  patch.cells.resize(kPatchRows * kCellStride, kEmpty);
  patch.sums.assign(kPatchRows * kSumStride, 0.0f);
  patch.filled.fill(0);
  find_candidates(hidden, x, y, patch.hidden);
  const Blocks moving = find_candidates(visible, x, y, patch.visible);
  const std::size_t most = std::max(patch.visible.x.size(), patch.hidden.x.size());
  patch.landings.resize(most);
  patch.uneven.resize(most);
  return moving;
}

void add_plane(const Sheet& visible, const Sheet& hidden, LensPoint lens, Blocks blocks,
               Patch& patch, Isa isa) {
  const int seen = find_landings(patch.visible, lens, isa, patch.landings);
  const Blocks others = note_moved(visible, seen, blocks, patch);
  if (others == 0) return;
  for_each_block(others, [&](int block) { add_moved_block(visible, block, patch, isa); });
  float *cells = patch.cells.data(), *sums = patch.sums.data();
  empty_cells(cells, others, isa);
  draw_landings(visible, patch.visible, seen, lens, others, patch, isa);
  const Blocks with_empty = add_cells(cells, others, sums, isa);
  for_each_block(others & ~with_empty,
                 [&](int block) { ++patch.filled[static_cast<std::size_t>(block)]; });
  if (with_empty == 0) return;
  count_cells(cells, with_empty, sums, isa);
  const int behind = find_landings(patch.hidden, lens, isa, patch.landings);
  draw_landings(hidden, patch.hidden, behind, lens, with_empty, patch, isa);
  add_cells(cells, with_empty, sums, isa);
  count_cells(cells, with_empty, sums, isa);
}

void finish_patch(const Sheet& visible, Patch& patch, Isa isa) {
  for_each_block(kAllBlocks, [&](int block) {
    add_moved_block(visible, block, patch, isa);
    float* counts = sum_block(patch.sums.data(), block) + 3 * kSumPlane;
    const auto filled = static_cast<float>(patch.filled[static_cast<std::size_t>(block)]);
    for (int i = 0; i < kBlock * kBlock; ++i) {
      counts[i / kBlock * kSumStride + i % kBlock] += filled;
    }
  });
}

}  // namespace softfocus

#else  // kernels

namespace {

// Pixels beside each other into cells beside each other, where they are nearer.
SOFTFOCUS_INLINE void put(const float* pixels, std::ptrdiff_t plane, Mask lanes, Floats radius,
                          float* cells) {
  const Floats before = load(cells);
  const Mask nearer = lanes & (radius < before);
  if (!any(nearer)) return;
  float *red = cells + kCellPlane, *green = red + kCellPlane, *blue = green + kCellPlane;
  store(cells, select(nearer, radius, before));
  store(red, select(nearer, load(pixels), load(red)));
  store(green, select(nearer, load(pixels + plane), load(green)));
  store(blue, select(nearer, load(pixels + 2 * plane), load(blue)));
}

// The rows of a tile that move alike, each to where its first pixel lands.
SOFTFOCUS_INLINE void put_row(const TilesToDraw& draw, const float* pixels, int x, int y) {
  for (int i = 0; i < kReachTile; i += kLanes) {
    put(pixels + i, draw.plane, Mask{} - 1, load(pixels + i + 3 * draw.plane),
        draw.cells + y * kCellStride + kCellMargin + x + i);
  }
}

// From where to where pixels move along an axis: they take their own cell and those that are
// left between it and a neighbour's.
struct Moves {
  Floats own, least, most;
};
SOFTFOCUS_INLINE Floats move_beside(Floats radius, const float* neighbour, Floats axis) {
  const Floats other = load(neighbour);
  const Mask same_surface = absolute(other - radius) <= kSurfaceStep;
  return nearest(select(same_surface, other, radius) * axis);
}
// Neighbours of one surface move at most one cell apart.
SOFTFOCUS_INLINE Moves moves(Floats radius, const float* from, std::ptrdiff_t step, float axis) {
  const Floats along = splat(axis), own = nearest(radius * along);
  return {own, smaller(move_beside(radius, from - step, along), own),
          larger(move_beside(radius, from + step, along), own)};
}

// A vector of pixels that moves to cells beside each other.
SOFTFOCUS_INLINE void put_inside(const TilesToDraw& draw, const float* pixels, Mask lanes,
                                 Floats radius, int to_x, int to_y) {
  if (to_x <= -kLanes || to_x >= kPatchColumns || to_y < 0 || to_y >= kPatchRows) return;
  put(pixels, draw.plane, lanes, radius, draw.cells + to_y * kCellStride + kCellMargin + to_x);
}

// Pixels that move in few ways: one way after the other.
SOFTFOCUS_INLINE void put_few(const TilesToDraw& draw, const float* pixels, int x, int y,
                              const UnevenRows& uneven, int row) {
  const float* from = pixels + 3 * draw.plane;
  const Floats radius = load(from);
  const int x0 = uneven.x0[row], x1 = uneven.x1[row], y0 = uneven.y0[row], y1 = uneven.y1[row];
  Moves across{}, down{};
  if (x0 != x1) across = moves(radius, from, 1, draw.lens.u);
  if (y0 != y1) down = moves(radius, from, draw.stride, draw.lens.v);
  for (int move_y = y0; move_y <= y1; ++move_y) {
    const auto to_y = static_cast<float>(move_y);
    const Mask in_row = y0 == y1 ? Mask{} - 1 : (down.least <= to_y) & (down.most >= to_y);
    for (int move_x = x0; move_x <= x1; ++move_x) {
      const auto to_x = static_cast<float>(move_x);
      const Mask in_column = x0 == x1 ? Mask{} - 1 : (across.least <= to_x) & (across.most >= to_x);
      put_inside(draw, pixels, in_row & in_column, radius, x + move_x, y + move_y);
    }
  }
}

// Pixels that move in many ways: those that move alike together.
inline void put_many(const TilesToDraw& draw, const float* pixels, int x, int y) {
  const float* from = pixels + 3 * draw.plane;
  const Floats radius = load(from);
  const Mask inside = radius < kEmpty;
  const Moves across = moves(radius, from, 1, draw.lens.u);
  const Moves down = moves(radius, from, draw.stride, draw.lens.v);
  float moves_x[kLanes], moves_y[kLanes];
  store(moves_x, across.own);
  store(moves_y, down.own);
  const Mask one_cell = (across.least == across.most) & (down.least == down.most);
  const unsigned more_cells = lane_bits(~one_cell);
  for (unsigned rest = lane_bits(inside); rest != 0;) {
    const int lane = __builtin_ctz(rest);
    const float own_x = moves_x[lane], own_y = moves_y[lane];
    const Mask group = inside & (across.own == own_x) & (down.own == own_y);
    const unsigned bits = lane_bits(group);
    rest &= ~bits;
    const int to_x = x + static_cast<int>(own_x), to_y = y + static_cast<int>(own_y);
    if ((bits & more_cells) == 0) {
      put_inside(draw, pixels, group, radius, to_x, to_y);
      continue;
    }
    for (int i = -1; i <= 1; ++i) {
      const float row = own_y + static_cast<float>(i);
      const Mask in_row = group & (down.least <= row) & (down.most >= row);
      if (!any(in_row)) continue;
      put_inside(draw, pixels, in_row & (across.least < own_x), radius, to_x - 1, to_y + i);
      put_inside(draw, pixels, in_row, radius, to_x, to_y + i);
      put_inside(draw, pixels, in_row & (across.most > own_x), radius, to_x + 1, to_y + i);
    }
  }
}

// Puts the rows of a tile that move alike into their cells, and lists the others that may reach
// the patch.
inline void put_even_rows(const TilesToDraw& draw, const Landing& landing, UnevenRows& uneven) {
  const float* pixels = draw.tile(landing.candidate);
  uneven.rows = 0;
  if (landing.even()) {
    const int first = landing.y0 > landing.first_row ? landing.y0 : landing.first_row;
    const int end =
        landing.y0 + kReachTile < landing.end_row ? landing.y0 + kReachTile : landing.end_row;
    for (int y = first; y < end; ++y) {
      put_row(draw, pixels + (y - landing.y0) * draw.stride, landing.x0, y);
    }
    return;
  }
  const int first = draw.tiles[landing.candidate] * kReachTile;
  const int x = draw.x[landing.candidate], y = draw.y[landing.candidate];
  for (int i = 0; i < kReachTile; i += kLanes) {
    const Floats least = load(draw.row_least + first + i), most = load(draw.row_most + first + i);
    const Floats across = least * draw.lens.u, across_too = most * draw.lens.u;
    const Floats down = least * draw.lens.v, down_too = most * draw.lens.v;
    const Ints x0 = round_to_int(smaller(across, across_too));
    const Ints x1 = round_to_int(larger(across, across_too));
    const Ints y0 = round_to_int(smaller(down, down_too));
    const Ints y1 = round_to_int(larger(down, down_too));
    const Ints row_y = y + i + lane_numbers();
    const Mask lands = (least <= most) & (x + x1 > -kReachTile) & (x + x0 < kPatchColumns) &
                       (row_y + y1 >= landing.first_row) & (row_y + y0 < landing.end_row);
    const Mask even = lands & (x0 == x1) & (y0 == y1);
    store(uneven.x0 + i, x0);
    store(uneven.x1 + i, x1);
    store(uneven.y0 + i, y0);
    store(uneven.y1 + i, y1);
    uneven.rows |= lane_bits(lands & ~even) << i;
    for (unsigned rows = lane_bits(even); rows != 0; rows &= rows - 1) {
      const int row = i + __builtin_ctz(rows);
      put_row(draw, pixels + row * draw.stride, x + uneven.x0[row], y + row + uneven.y0[row]);
    }
  }
}

// A row of a tile whose pixels do not all move alike.
SOFTFOCUS_INLINE void put_uneven_row(const TilesToDraw& draw, int candidate,
                                     const UnevenRows& uneven, int row) {
  const float* pixels = draw.tile(candidate) + row * draw.stride;
  const int x = draw.x[candidate], y = draw.y[candidate] + row;
  const int ways = (uneven.x1[row] - uneven.x0[row] + 1) * (uneven.y1[row] - uneven.y0[row] + 1);
  for (int i = 0; i < kReachTile; i += kLanes) {
    if (ways <= kFewWays) {
      put_few(draw, pixels + i, x + i, y, uneven, row);
    } else {
      put_many(draw, pixels + i, x + i, y);
    }
  }
}

}  // namespace

/// Puts the pixels of tiles into the cells that they reach.
// If two pixels of the same radius are in one cell, the upper one stays. That takes an order only
// between rows that do not move alike: no pixel of the others can meet its own radius.
void draw_tiles(const TilesToDraw& draw) {
  for (int first = 0, end = 0; first < draw.count; first = end) {
    const int y = draw.y[draw.landings[first].candidate];
    std::uint32_t rows = 0;
    for (; end < draw.count && draw.y[draw.landings[end].candidate] == y; ++end) {
      put_even_rows(draw, draw.landings[end], draw.uneven[end]);
      rows |= draw.uneven[end].rows;
    }
    for (; rows != 0; rows &= rows - 1) {
      const int row = __builtin_ctz(rows);
      for (int i = first; i < end; ++i) {
        if ((draw.uneven[i].rows >> row & 1u) == 0) continue;
        put_uneven_row(draw, draw.landings[i].candidate, draw.uneven[i], row);
      }
    }
  }
}

#endif

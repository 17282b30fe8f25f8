#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).
// Isa::scalar runs the baseline kernels, which need no vector unit.

#include "dof/object_layers/object_layers.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "dof/disc_layers/disc_levels.h"
#include "dof/disc_layers/disc_slopes.h"
#include "dof/level_stack.h"
#include "dof/object_layers/hidden_parts.h"
#include "dof/object_layers/object_rungs.h"

namespace softfocus {

// Rows of the planes of Surfaces, from some pixel on.
struct SurfaceRow {
  const float* visible[4];
  const float* hidden[hidden_plane::kCount];
};

inline constexpr int kSeen = 4;  // beside red, green, blue and kLevelWeight

// A layer's channels in a tile and around it, and where they are summed over discs.
struct ObjectScratch {
  float channel[kSeen + 1][kDiscTileRows][kDiscTileRow];
  float columns[2][kDiscApron][kDiscTileRow];
  float sums[kSeen + 1][kLevelTileHeight][kLevelTileWidth];
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "dof/object_layers/object_layers.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

struct ObjectLevel {
  int width, height;
  LevelPlanes seen[2];
};

struct ObjectWorkspace {
  SeenTile tile;
  ObjectScratch scratch;
  // Rows of the picture that become one of a level, copies of those that leave the picture, and
  // the sums of its columns.
  std::vector<SurfaceRow> rows;
  std::vector<std::vector<float>> outside;
  std::vector<float> fine;
};

struct ObjectFrame {
  const Surfaces& surfaces;
  const ObjectLadder& ladder;
  const LayerMarks& marks;
  std::span<const ObjectLevel> levels;
  Isa isa;

  // The layers of a level that may reach into a rectangle: bits, the smallest rung's the lowest.
  std::uint32_t layers_near(std::size_t level, int side, const LevelRectangle& at) const {
    const int size = 1 << level;
    const std::uint64_t rungs =
        marks.rungs_in(side, (at.x - kDiscApron) * size, (at.y - kDiscApron) * size,
                       (at.width + 2 * kDiscApron) * size, (at.height + 2 * kDiscApron) * size);
    const auto count = static_cast<int>(ladder.levels[level].rungs.size());
    return static_cast<std::uint32_t>(rungs >> first_rung(level) &
                                      ((std::uint64_t{1} << count) - 1));
  }
  bool any_near(std::size_t level, int side, const LevelRectangle& at) const {
    return layers_near(level, side, at) != 0;
  }
  bool any_wanted(std::size_t level, int side, const LevelRectangle& at) const {
    return any_seen(*this, level, side, at);
  }
};

// --- a layer's rows ---

// A number of pixels, and those that the last vector takes along.
int whole_vectors(int count) { return (count + kMostLanes - 1) / kMostLanes * kMostLanes; }

// `count` pixels from `x` on, which is inside; rows and columns outside repeat the picture's last.
SurfaceRow surface_row(const Surfaces& surfaces, int x, int y, int count,
                       std::vector<float>& outside) {
  const Planes& visible = surfaces.visible;
  const Planes& hidden = surfaces.hidden;
  const int inside_y = std::min(y, visible.height - 1);
  SurfaceRow row{};
  const bool inside = x + count <= visible.stride;
  if (!inside) outside.resize(static_cast<std::size_t>(count) * (4 + hidden_plane::kCount));
  float* to = outside.data();
  const auto channel = [&](const float* from) {
    if (inside) return from + x;
    const int there = std::min(visible.width - x, count);
    std::copy_n(from + x, there, to);
    std::fill_n(to + there, count - there, from[visible.width - 1]);
    to += count;
    return static_cast<const float*>(to - count);
  };
  for (int i = 0; i < 4; ++i) row.visible[i] = channel(plane_row(visible, i, inside_y));
  for (int i = 0; i < hidden_plane::kCount; ++i) {
    row.hidden[i] = channel(plane_row(hidden, i, inside_y));
  }
  return row;
}

// A row of a layer's channels in a level's pixels, means of the picture's. Pixels outside the
// level are those of its border.
void make_row(const ObjectFrame& frame, std::size_t level, const ObjectRung& layer, int x, int y,
              ObjectWorkspace& work, int to_row) {
  const ObjectLevel& of = frame.levels[level];
  const int inside_y = std::clamp(y, 0, of.height - 1);
  const int begin = std::max(x, 0), end = std::min(x + kDiscTileRow, of.width);
  const int size = 1 << level, count = (end - begin) * size;
  work.rows.resize(static_cast<std::size_t>(size));
  work.outside.resize(std::max(work.outside.size(), work.rows.size()));
  for (int row = 0; row < size; ++row) {
    const auto number = static_cast<std::size_t>(row);
    work.rows[number] = surface_row(frame.surfaces, begin * size, inside_y * size + row,
                                    whole_vectors(count), work.outside[number]);
  }
  const int room = whole_vectors(kDiscTileRow * size);
  work.fine.resize(static_cast<std::size_t>(room) * (kSeen + 1));
  float* fine[kSeen + 1];
  for (int i = 0; i <= kSeen; ++i) fine[i] = work.fine.data() + i * room;
  SOFTFOCUS_KERNEL(frame.isa, split_layer)(work.rows.data(), size, layer, count, fine);
  const float scale = 1.0f / static_cast<float>(size * size);
  for (int i = 0; i <= kSeen; ++i) {
    if (level > 0) SOFTFOCUS_KERNEL(frame.isa, mean_of_pixels)(fine[i], end - begin, size, scale);
    float* to = work.scratch.channel[i][to_row];
    std::fill(to, to + (begin - x), fine[i][0]);
    std::copy_n(fine[i], end - begin, to + (begin - x));
    std::fill(to + (end - x), to + kDiscTileRow, fine[i][end - begin - 1]);
  }
}

void blur_layer(const ObjectFrame& frame, std::size_t level, const ObjectRung& layer,
                const LevelRectangle& at, ObjectWorkspace& work) {
  const int reach = static_cast<int>(layer.rung->spans.size()) - 1;
  for (int y = 0; y < at.height + 2 * (reach + 1); ++y) {
    make_row(frame, level, layer, at.x - kDiscMargin, at.y + y - reach - 1, work, y);
  }
  SOFTFOCUS_KERNEL(frame.isa, blur_object_layer)
  (*layer.rung, at.height, work.scratch, work.tile);
}

// --- levels ---

void add_near(const ObjectFrame& frame, std::size_t level, const LevelRectangle& at,
              ObjectWorkspace& work) {
  const std::vector<ObjectRung>& layers = frame.ladder.near[level];
  const std::uint32_t marked = frame.layers_near(level, 0, at);
  const std::size_t last = frame.ladder.levels[level].rungs.size() - 1;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    if ((marked >> (last - i) & 1u) != 0) blur_layer(frame, level, layers[i], at, work);
  }
}

void add_far(const ObjectFrame& frame, std::size_t level, const LevelRectangle& at,
             ObjectWorkspace& work) {
  const std::vector<ObjectRung>& layers = frame.ladder.far[level];
  std::uint32_t marked = frame.layers_near(level, 1, at);
  if (level == 0) marked |= frame.layers_near(level, 0, at) & 1u;  // the layer in focus
  for (std::size_t i = 0; i < layers.size(); ++i) {
    if ((marked >> i & 1u) != 0) blur_layer(frame, level, layers[i], at, work);
  }
}

struct Levels {
  std::vector<ObjectLevel> levels;
  RowMemory<float> memory;
};
Levels make_levels(int width, int height, std::size_t count, MemoryShelf& shelf) {
  Levels made;
  for (; made.levels.size() < count; width = (width + 1) / 2, height = (height + 1) / 2) {
    made.levels.push_back({width, height, {}});
  }
  // Counts floats first, then takes them.
  for (const bool counting : {true, false}) {
    std::size_t used = 0;
    for (ObjectLevel& level : made.levels) {
      if (&level == &made.levels[0]) continue;
      for (LevelPlanes& seen : level.seen) {
        seen = take_planes(kSeenChannels, level.width, level.height, made.memory.get(), used);
      }
    }
    if (counting) made.memory = make_row_memory<float>(used, &shelf);
  }
  return made;
}

}  // namespace

void object_layers(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  const CentredDiscs centred = centre_discs(input, pool);
  DofInput of_centred = input;
  of_centred.scene = centred.picture;
  const Surfaces surfaces = find_surfaces(of_centred, pool);
  const LayerMarks marks = mark_layers(surfaces, pool);
  const ObjectLadder ladder = make_object_ladder(input.settings.max_coc_px);
  const Levels made = make_levels(result.width, result.height, ladder.levels.size(), pool.memory());
  const ObjectFrame frame{surfaces, ladder, marks, made.levels, pool.isa()};
  see_levels<ObjectWorkspace>(
      frame, pool,
      [&](std::size_t level, int side, const LevelRectangle& at, ObjectWorkspace& work) {
        (side == 0 ? add_near : add_far)(frame, level, at, work);
      });
  for_each_tile<ObjectWorkspace>(frame.levels[0], pool,
                                 [&](const LevelRectangle& at, ObjectWorkspace& work) {
                                   start_tile(frame, 0, 0, at, work.tile);
                                   add_near(frame, 0, at, work);
                                   add_far(frame, 0, at, work);
                                   add_larger_behind(frame, 0, at, work.tile);
                                   store_tile(input, result, at, work.tile, nullptr, frame.isa);
                                 });
}

}  // namespace softfocus

#else  // kernels

namespace {

#include "dof/level_lanes.inl"

#include "dof/disc_layers/disc_sums.inl"

SOFTFOCUS_INLINE Floats share_behind(LayerBegin begin, Floats square) {
  return saturate(square * begin.slope + begin.offset);
}

SOFTFOCUS_INLINE Floats signed_square(Floats radius) { return radius * absolute(radius); }

// A layer's channels of the pixels from `x` on.
SOFTFOCUS_INLINE void split_pixels(const SurfaceRow& row, const ObjectRung& layer, int x,
                                   Floats* values) {
  const Floats one = splat(1.0f), none = splat(0.0f);
  const Floats visible = signed_square(load(row.visible[3] + x));
  const Floats behind = share_behind(layer.begin, visible);
  const Floats shown = behind - share_behind(layer.next, visible);
  for (int i = 0; i < 3; ++i) values[i] = shown * load(row.visible[i] + x);
  values[kLevelWeight] = shown;
  values[kSeen] = behind;
  const Floats share = load(row.hidden[hidden_plane::kShare] + x);
  if (all(share == none)) return;
  const Floats hidden = signed_square(load(row.hidden[hidden_plane::kRadius] + x));
  const Floats farthest = signed_square(load(row.hidden[hidden_plane::kFarthest] + x));
  const Floats hidden_behind = share_behind(layer.begin, hidden);
  const Floats covered = share * (hidden_behind - share_behind(layer.next, hidden)) * (one - shown);
  const Floats more = larger(share * hidden_behind - behind, none);
  for (int i = 0; i < 3; ++i) values[i] += covered * load(row.hidden[i] + x);
  values[kLevelWeight] = shown + covered;
  values[kSeen] =
      larger(values[kLevelWeight], behind + more * (one - share_behind(layer.before, farthest)));
}

}  // namespace

/// A layer's channels of `count` pixels, sums over the columns of some rows.
void split_layer(const SurfaceRow* rows, int row_count, const ObjectRung& layer, int count,
                 float* const* to) {
  for (int x = 0; x < count; x += kLanes) {
    Floats sums[kSeen + 1];
    split_pixels(rows[0], layer, x, sums);
    for (int row = 1; row < row_count; ++row) {
      Floats values[kSeen + 1];
      split_pixels(rows[row], layer, x, values);
      for (int i = 0; i <= kSeen; ++i) sums[i] += values[i];
    }
    for (int i = 0; i <= kSeen; ++i) store(to[i] + x, sums[i]);
  }
}

/// Pixels of a level in place of sums of the picture's columns, `size` columns a pixel.
void mean_of_pixels(float* columns, int count, int size, float scale) {
  for (int of_pixel = size; of_pixel > 1; of_pixel /= 2) {
    for (int x = 0; x < count * of_pixel / 2; x += kLanes) {
      store(columns + x, add_pairs(load(columns + 2 * x), load(columns + 2 * x + kLanes)));
    }
  }
  for (int x = 0; x < count; x += kLanes) store(columns + x, scale * load(columns + x));
}

/// Sums a layer's channels over discs, and adds it behind the nearer ones.
void blur_object_layer(const Rung& rung, int height, ObjectScratch& scratch, SeenTile& tile) {
  const int reach = static_cast<int>(rung.spans.size()) - 1;
  const LadderSpan* spans = rung.spans.data();
  Mask all_ones = splat(-1), all_own = splat(-1);
  for (int y = 0; y < height + 2 * (reach + 1); ++y) {
    for (int x = 0; x < kDiscTileRow; x += kLanes) {
      const Floats seen = load(scratch.channel[kSeen][y] + x);
      all_ones &= seen == 1.0f;
      all_own &= seen == load(scratch.channel[kLevelWeight][y] + x);
    }
  }
  int seen_sums = kLevelWeight;
  for (int i = 0; i < kSeen; ++i) {
    sum_discs(spans, reach, height, 0, kWholeTile.columns, scratch.channel[i], scratch.columns,
              scratch.sums[i]);
  }
  if (!all(all_own)) {
    seen_sums = kSeen;
    if (all(all_ones)) {
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < kLevelTileWidth; x += kLanes) {
          store(scratch.sums[kSeen][y] + x, splat(rung.area));
        }
      }
    } else {
      sum_discs(spans, reach, height, 0, kWholeTile.columns, scratch.channel[kSeen],
                scratch.columns, scratch.sums[kSeen]);
    }
  }
  add_layer(scratch.sums, scratch.sums[seen_sums], {0, height, 0, kWholeTile.columns}, tile);
}

#endif

#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).
// Isa::scalar runs the baseline kernels, which need no vector unit.

#include "dof/object_layers/object_layers.h"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "dof/disc_layers/disc_levels.h"
#include "dof/object_layers/hidden_parts.h"
#include "dof/object_layers/object_rungs.h"
#include "raster/threads/scratch_shelf.h"

namespace softfocus {

// Rows of the planes of Surfaces, from some pixel on.
struct SurfaceRow {
  const float* visible[4];
  const float* hidden[hidden_plane::kCount];
};

inline constexpr int kSeen = 4;  // beside red, green, blue and kDiscWeight

// A layer's channels in a tile and around it, and where they are summed over discs.
struct ObjectScratch {
  float channel[kSeen + 1][kDiscTileRows][kDiscTileRow];
  float columns[2][kDiscApron][kDiscTileRow];
  float sums[kSeen + 1][kDiscTileHeight][kDiscTileWidth];
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "dof/object_layers/object_layers.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

struct Rectangle {
  int x, y, width, height;
};

// A level's size in its pixels, and what is seen of it and of larger ones on either side of the
// focus: colour and transmittance. A row has kDiscMargin more pixels at either end, and then room
// for a whole tile.
struct Level {
  int width, height;
  Planes seen[2];
};

struct Workspace {
  DiscTile tile;
  ObjectScratch scratch;
  float enlarged[4][kDiscTileRow];
  // Rows of the picture that become one of a level, copies of those that leave the picture, and
  // the sums of its columns.
  std::vector<SurfaceRow> rows;
  std::vector<std::vector<float>> outside;
  std::vector<float> fine;
};

struct Frame {
  const Surfaces& surfaces;
  const ObjectLadder& ladder;
  const LayerMarks& marks;
  std::vector<Level>& levels;
  Isa isa;
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
void make_row(const Frame& frame, std::size_t level, const ObjectRung& layer, int x, int y,
              Workspace& work, int to_row) {
  const Level& of = frame.levels[level];
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

void blur_layer(const Frame& frame, std::size_t level, const ObjectRung& layer, const Rectangle& at,
                Workspace& work) {
  const int reach = static_cast<int>(layer.rung->spans.size()) - 1;
  for (int y = 0; y < at.height + 2 * (reach + 1); ++y) {
    make_row(frame, level, layer, at.x - kDiscMargin, at.y + y - reach - 1, work, y);
  }
  SOFTFOCUS_KERNEL(frame.isa, blur_object_layer)
  (*layer.rung, at.height, work.scratch, work.tile);
}

// --- levels ---

// A tile's place in the next level, with the pixels around it that enlarging needs.
Rectangle in_next_level(const Rectangle& at) {
  return {at.x / 2 - 1, at.y / 2 - 1, at.width / 2 + 2, at.height / 2 + 2};
}

// The layers of a level that may reach into a rectangle: bits, the smallest rung's the lowest.
std::uint32_t layers_near(const Frame& frame, std::size_t level, int side, const Rectangle& at) {
  const int size = 1 << level;
  const std::uint64_t rungs =
      frame.marks.rungs_in(side, (at.x - kDiscApron) * size, (at.y - kDiscApron) * size,
                           (at.width + 2 * kDiscApron) * size, (at.height + 2 * kDiscApron) * size);
  const auto count = static_cast<int>(frame.ladder.levels[level].rungs.size());
  return static_cast<std::uint32_t>(rungs >> first_rung(level) & ((std::uint64_t{1} << count) - 1));
}

// Whether a level or a larger one has anything of that side to show in a rectangle.
bool any_seen(const Frame& frame, std::size_t level, int side, const Rectangle& at) {
  if (level == frame.levels.size()) return false;
  if (layers_near(frame, level, side, at) != 0) return true;
  return any_seen(frame, level + 1, side, in_next_level(at));
}

void enlarge(const Frame& frame, const Level& from, int side, const Rectangle& at, int row,
             float* const (&to)[kDiscTransmitted + 1]) {
  const int y = at.y + row;
  const int inside = y / 2;
  const int other = std::clamp(y % 2 == 0 ? inside - 1 : inside + 1, 0, from.height - 1);
  for (int i = 0; i <= kDiscTransmitted; ++i) {
    SOFTFOCUS_KERNEL(frame.isa, enlarge_object_row)
    (plane_row(from.seen[side], i, inside) + kDiscMargin + at.x / 2,
     plane_row(from.seen[side], i, other) + kDiscMargin + at.x / 2, at.width + at.width % 2, to[i]);
  }
}

void start_tile(const Frame& frame, std::size_t level, const Rectangle& at, bool before_focus,
                DiscTile& tile) {
  const bool any = before_focus && any_seen(frame, level + 1, 0, in_next_level(at));
  for (int y = 0; y < at.height; ++y) {
    const std::size_t row = static_cast<std::size_t>(y);
    float* const to[] = {tile.channel[0][row], tile.channel[1][row], tile.channel[2][row],
                         tile.channel[3][row]};
    if (any) {
      enlarge(frame, frame.levels[level + 1], 0, at, y, to);
    } else {
      for (int i = 0; i < 3; ++i) std::fill_n(to[i], kDiscTileWidth, 0.0f);
      std::fill_n(to[kDiscTransmitted], kDiscTileWidth, 1.0f);
    }
  }
}

void add_near(const Frame& frame, std::size_t level, const Rectangle& at, Workspace& work) {
  start_tile(frame, level, at, true, work.tile);
  const std::vector<ObjectRung>& layers = frame.ladder.near[level];
  const std::uint32_t marked = layers_near(frame, level, 0, at);
  const std::size_t last = frame.ladder.levels[level].rungs.size() - 1;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    if ((marked >> (last - i) & 1u) != 0) blur_layer(frame, level, layers[i], at, work);
  }
}

void add_far(const Frame& frame, std::size_t level, const Rectangle& at, Workspace& work) {
  const std::vector<ObjectRung>& layers = frame.ladder.far[level];
  std::uint32_t marked = layers_near(frame, level, 1, at);
  if (level == 0) marked |= layers_near(frame, level, 0, at) & 1u;  // the layer in focus
  for (std::size_t i = 0; i < layers.size(); ++i) {
    if ((marked >> i & 1u) != 0) blur_layer(frame, level, layers[i], at, work);
  }
  if (!any_seen(frame, level + 1, 1, in_next_level(at))) return;
  float* const to[] = {work.enlarged[0], work.enlarged[1], work.enlarged[2], work.enlarged[3]};
  for (int y = 0; y < at.height; ++y) {
    enlarge(frame, frame.levels[level + 1], 1, at, y, to);
    SOFTFOCUS_KERNEL(frame.isa, add_object_row_behind)(work.enlarged, at.width, y, work.tile);
  }
}

template <class Body>
void for_each_tile(const Level& level, ThreadPool& pool, const Body& body) {
  const int columns = (level.width + kDiscTileWidth - 1) / kDiscTileWidth;
  const int rows = (level.height + kDiscTileHeight - 1) / kDiscTileHeight;
  ScratchShelf<std::unique_ptr<Workspace>> shelf;
  pool.for_each(columns * rows, [&](int task) {
    std::unique_ptr<Workspace> work = shelf.take();
    if (!work) work = std::make_unique<Workspace>();
    const int x = task % columns * kDiscTileWidth, y = task / columns * kDiscTileHeight;
    body(Rectangle{x, y, std::min(kDiscTileWidth, level.width - x),
                   std::min(kDiscTileHeight, level.height - y)},
         *work);
    shelf.put_back(std::move(work));
  });
}

void keep_tile(Level& level, int side, const Rectangle& at, const DiscTile& tile) {
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
  Level& level = frame.levels[number];
  for_each_tile(level, pool, [&](const Rectangle& at, Workspace& work) {
    // Leaves out tiles that the level before does not read: its tiles read half their size and
    // two pixels more, if there is anything in them.
    constexpr int kBeside = kDiscTileWidth / 2 + 2, kBelow = kDiscTileHeight / 2 + 2;
    const Rectangle around{at.x - kBeside, at.y - kBelow, at.width + 2 * kBeside,
                           at.height + 2 * kBelow};
    if (any_seen(frame, number, 0, around)) {
      add_near(frame, number, at, work);
      keep_tile(level, 0, at, work.tile);
    }
    if (any_seen(frame, number, 1, around)) {
      start_tile(frame, number, at, false, work.tile);
      add_far(frame, number, at, work);
      keep_tile(level, 1, at, work.tile);
    }
  });
}

std::vector<Level> make_levels(int width, int height, std::size_t count) {
  std::vector<Level> levels;
  for (std::size_t i = 0; i < count; ++i) {
    Level& level = levels.emplace_back(Level{width, height, {}});
    if (i > 0) {
      for (Planes& seen : level.seen) {
        seen = make_planes(kDiscTransmitted + 1, width + 2 * kDiscMargin + kDiscTileWidth, height);
      }
    }
    width = (width + 1) / 2;
    height = (height + 1) / 2;
  }
  return levels;
}

}  // namespace

void object_layers(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  const Surfaces surfaces = find_surfaces(input, pool);
  const LayerMarks marks = mark_layers(surfaces, pool);
  const ObjectLadder ladder = make_object_ladder(input.settings.max_coc_px);
  std::vector<Level> levels = make_levels(result.width, result.height, ladder.levels.size());
  const Frame frame{surfaces, ladder, marks, levels, pool.isa()};
  for (std::size_t i = levels.size(); i-- > 1;) see_level(frame, i, pool);
  for_each_tile(levels[0], pool, [&](const Rectangle& at, Workspace& work) {
    add_near(frame, 0, at, work);
    add_far(frame, 0, at, work);
    SOFTFOCUS_KERNEL(pool.isa(), divide_by_opacity)(at.height, work.tile);
    for (int y = 0; y < at.height; ++y) {
      const auto row = static_cast<std::size_t>(y);
      const auto& channel = work.tile.channel;
      store_span(input, result, at.x, at.y + y, at.width, channel[0][row], channel[1][row],
                 channel[2][row], pool.isa());
    }
  });
}

}  // namespace softfocus

#else  // kernels

namespace {

#include "dof/picture_lanes.inl"

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
  values[kDiscWeight] = shown;
  values[kSeen] = behind;
  const Floats share = load(row.hidden[hidden_plane::kShare] + x);
  if (all(share == none)) return;
  const Floats hidden = signed_square(load(row.hidden[hidden_plane::kRadius] + x));
  const Floats farthest = signed_square(load(row.hidden[hidden_plane::kFarthest] + x));
  const Floats hidden_behind = share_behind(layer.begin, hidden);
  const Floats covered = share * (hidden_behind - share_behind(layer.next, hidden)) * (one - shown);
  const Floats more = larger(share * hidden_behind - behind, none);
  for (int i = 0; i < 3; ++i) values[i] += covered * load(row.hidden[i] + x);
  values[kDiscWeight] = shown + covered;
  values[kSeen] =
      larger(values[kDiscWeight], behind + more * (one - share_behind(layer.before, farthest)));
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
  using Lanes = std::make_index_sequence<SOFTFOCUS_LANES>;
  for (int of_pixel = size; of_pixel > 1; of_pixel /= 2) {
    for (int x = 0; x < count * of_pixel / 2; x += kLanes) {
      const Floats a = load(columns + 2 * x), b = load(columns + 2 * x + kLanes);
      store(columns + x, every_other<0>(a, b, Lanes{}) + every_other<1>(a, b, Lanes{}));
    }
  }
  for (int x = 0; x < count; x += kLanes) store(columns + x, scale * load(columns + x));
}

/// Sums a layer's channels over discs, and adds it behind the nearer ones.
void blur_object_layer(const Rung& rung, int height, ObjectScratch& scratch, DiscTile& tile) {
  const int reach = static_cast<int>(rung.spans.size()) - 1;
  const LadderSpan* spans = rung.spans.data();
  Mask all_ones = splat(-1), all_own = splat(-1);
  for (int y = 0; y < height + 2 * (reach + 1); ++y) {
    for (int x = 0; x < kDiscTileRow; x += kLanes) {
      const Floats seen = load(scratch.channel[kSeen][y] + x);
      all_ones &= seen == 1.0f;
      all_own &= seen == load(scratch.channel[kDiscWeight][y] + x);
    }
  }
  int seen_sums = kDiscWeight;
  for (int i = 0; i < kSeen; ++i) {
    sum_discs(spans, reach, height, 0, kWholeTile.columns, scratch.channel[i], scratch.columns,
              scratch.sums[i]);
  }
  if (!all(all_own)) {
    seen_sums = kSeen;
    if (all(all_ones)) {
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < kDiscTileWidth; x += kLanes) {
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

/// enlarge_row() of disc_sums.inl.
void enlarge_object_row(const float* inside, const float* other, int count, float* to) {
  enlarge_row(inside, other, count, to);
}

/// add_row_behind() of disc_sums.inl.
void add_object_row_behind(const float (*from)[kDiscTileRow], int width, int y, DiscTile& tile) {
  add_row_behind(from, width, y, tile);
}

void divide_by_opacity(int height, DiscTile& tile) {
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < kDiscTileWidth; x += kLanes) {
      const Floats scale = 1.0f / (1.0f - load(tile.channel[kDiscTransmitted][y] + x));
      for (int i = 0; i < 3; ++i) {
        float* to = tile.channel[i][y] + x;
        store(to, load(to) * scale);
      }
    }
  }
}

#endif

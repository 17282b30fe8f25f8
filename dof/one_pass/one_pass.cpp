#ifndef SOFTFOCUS_ISA

#include "dof/one_pass/one_pass.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "dof/focus_map.h"
#include "dof/weights.h"
#include "raster/images/texel.h"
#include "raster/threads/loops.h"

namespace softfocus {

std::vector<RingTap> ring_taps(float radius_px) {
  const int reach = tap_count(radius_px);
  struct Ringed {
    int ring;
    RingTap tap;
  };
  std::vector<Ringed> found;
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      const float distance = std::sqrt(static_cast<float>(dx * dx + dy * dy));
      if ((dx == 0 && dy == 0) || !(distance < radius_px)) continue;
      found.push_back({static_cast<int>(distance + 0.5f), {dx, dy, distance}});
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Ringed& a, const Ringed& b) { return a.ring < b.ring; });
  std::vector<RingTap> taps;
  taps.reserve(found.size());
  for (const Ringed& entry : found) taps.push_back(entry.tap);
  return taps;
}

// --- scalar: bands of rows, each pixel's radius and intensity computed once ---

namespace {

constexpr int kBandRows = 32;

struct Area {
  int x_begin, y_begin, x_end, y_end;
};

// The pixels of an area as filter texels, and `margin` more on every side. The picture's edge
// repeats outwards.
struct Band {
  Area area;
  int margin;
  int stride;
  std::vector<FilterTexel> texels;

  const FilterTexel* at(int x, int y) const {
    return &texels[static_cast<std::size_t>((y - area.y_begin + margin) * stride + x -
                                            area.x_begin + margin)];
  }
};

Band fill_band(const DofInput& input, const Area& area, int margin) {
  const ConstImageView& scene = input.scene;
  Band band{area, margin, area.x_end - area.x_begin + 2 * margin, {}};
  const int rows = area.y_end - area.y_begin + 2 * margin;
  band.texels.resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(band.stride));
  std::size_t next = 0;
  for (int y = area.y_begin - margin; y < area.y_end + margin; ++y) {
    const int inside_y = std::clamp(y, 0, scene.height - 1);
    for (int x = area.x_begin - margin; x < area.x_end + margin; ++x) {
      const glm::vec4 texel =
          load_texel<Format::rgba16f>(scene, std::clamp(x, 0, scene.width - 1), inside_y);
      band.texels[next++] =
          filter_texel(input.settings, glm::vec3{texel.x, texel.y, texel.z}, texel.w);
    }
  }
  return band;
}

// No tap goes farther than the margin.
void filter_area(const DofInput& input, const ImageView& result, const Area& area,
                 std::span<const RingTap> taps, int margin) {
  const Band band = fill_band(input, area, margin);
  for (int y = area.y_begin; y < area.y_end; ++y) {
    for (int x = area.x_begin; x < area.x_end; ++x) {
      const FilterTexel* centre = band.at(x, y);
      const float receiver_leakage = leakage(centre->radius_px, input.settings.leak);
      Gather gather = begin_gather(*centre);
      for (const RingTap& tap : taps) {
        add_neighbour(gather, *(centre + tap.dy * band.stride + tap.dx), tap.distance_px,
                      receiver_leakage);
      }
      const float depth = load_texel<Format::rgba16f>(input.scene, x, y).w;
      store_texel<Format::rgba16f>(result, x, y, glm::vec4{resolve(gather), depth}, input.profile);
    }
  }
}

void one_pass_scalar(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  const ConstImageView& scene = input.scene;
  const float radius = largest_filter_radius(input, pool);
  const std::vector<RingTap> taps = ring_taps(radius);
  pool.for_each((scene.height + kBandRows - 1) / kBandRows, [&](int number) {
    const int y = number * kBandRows;
    if (!input.kept.meets(0, y, scene.width, y + kBandRows)) return;
    const Area area{0, y, scene.width, std::min(y + kBandRows, scene.height)};
    filter_area(input, result, area, taps, tap_count(radius));
  });
}

Area area_of(const OnePassBlock& block, const ConstImageView& scene) {
  const int x = block.column * kBlockWidth, y = block.row * kBlockHeight;
  return {x, y, std::min(x + kBlockWidth, scene.width), std::min(y + kBlockHeight, scene.height)};
}

void blocks_scalar(const DofInput& input, std::span<const OnePassBlock> blocks, int farthest,
                   const ImageView& result, ThreadPool& pool) {
  const std::vector<RingTap> taps = ring_taps(static_cast<float>(farthest + 1));
  pool.for_each(static_cast<int>(blocks.size()), [&](int number) {
    const OnePassBlock& block = blocks[static_cast<std::size_t>(number)];
    // Rings in order: a tap in a ring past this one is farther than the reach.
    const auto end = std::partition_point(taps.begin(), taps.end(), [&](const RingTap& tap) {
      return static_cast<int>(tap.distance_px + 0.5f) <= block.reach + 1;
    });
    const auto count = static_cast<std::size_t>(end - taps.begin());
    filter_area(input, result, area_of(block, input.scene), std::span{taps}.first(count),
                block.reach + 1);
  });
}

}  // namespace

// --- lanes: tiles, and in them only cells that something blurs ---

namespace {

// A RingTap in the planes of a tile.
struct TileTap {
  std::int32_t offset;  // from the receiver's place in a plane
  float distance_px;
};

// The pixels of a tile and around it, in planes of rows. A window is the kLanes places from
// any place on: what a vector there holds.
struct TilePlanes {
  int stride;          // from row to row
  std::size_t length;  // from plane to plane

  float* whole;  // intensity; intensity * red, green, blue: a tap of overlap 1 and leakage 1
  float* part;   // radius, its sign set beyond the focus; red, green, blue

  float* least;      // the least radius in the window that begins here
  float* least_all;  // `least`, but 0 if a pixel of the window lies beyond the focus
  float* most;       // the largest radius in the window
};

// A part of two rows of the picture. Past the picture's edge the lower row has no target.
struct TileRows {
  int x_begin, x_end;
  int width;  // of the picture
  const std::uint16_t* from[2];
  std::uint16_t* to[2];
};

}  // namespace
}  // namespace softfocus

#define SOFTFOCUS_KERNELS "dof/one_pass/one_pass.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

constexpr int kTileWidth = 2 * kCellWidth;
constexpr int kTileHeight = 2 * kCellHeight;

// Tiles add whole rings; the last ring goes farther than the reach by this.
constexpr int kRingExcess = 1;

// The parts of a tile that need the filter, and how far their taps go. They begin at whole
// vectors of the tile.
struct TileTask {
  struct Part {
    Area area;
    int reach;
  };
  std::vector<Part> parts;
  int reach = 0;

  void add(const Area& area, int part_reach) {
    parts.push_back({area, part_reach});
    reach = std::max(reach, part_reach);
  }
};

// How far the taps of a cell must go: the farthest reach of pixels that reach it.
int reach_of_cell(const FocusMap& map, int column, int row, int farthest) {
  const int columns = (farthest + kCellWidth - 1) / kCellWidth;
  const int rows = (farthest + kCellHeight - 1) / kCellHeight;
  const auto gap = [](int cells, int size) { return std::max((cells - 1) * size + 1, 0); };
  int reach = 0;
  for (int y = std::max(row - rows, 0); y <= std::min(row + rows, map.rows - 1); ++y) {
    for (int x = std::max(column - columns, 0); x <= std::min(column + columns, map.columns - 1);
         ++x) {
      const int by = tap_count(largest_px(map, x, y));
      const bool reaches =
          by >= gap(std::abs(x - column), kCellWidth) && by >= gap(std::abs(y - row), kCellHeight);
      if (reaches) reach = std::max(reach, by);
    }
  }
  return reach;
}

// Costliest tiles first, so that threads end together.
void sort_by_cost(std::vector<TileTask>& tasks) {
  std::erase_if(tasks, [](const TileTask& task) { return task.reach == 0; });
  std::stable_sort(tasks.begin(), tasks.end(),
                   [](const TileTask& a, const TileTask& b) { return a.reach > b.reach; });
}

std::vector<TileTask> tiles_of(const ConstImageView& scene) {
  const int across = (scene.width + kTileWidth - 1) / kTileWidth;
  const int down = (scene.height + kTileHeight - 1) / kTileHeight;
  return std::vector<TileTask>(static_cast<std::size_t>(across * down));
}

TileTask& tile_of(std::vector<TileTask>& tiles, const ConstImageView& scene, int x, int y) {
  const int across = (scene.width + kTileWidth - 1) / kTileWidth;
  return tiles[static_cast<std::size_t>(y / kTileHeight * across + x / kTileWidth)];
}

std::vector<TileTask> plan_tiles(const DofInput& input, const FocusMap& map, int farthest) {
  const ConstImageView& scene = input.scene;
  std::vector<TileTask> tiles = tiles_of(scene);
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      const int reach = reach_of_cell(map, column, row, farthest);
      if (reach == 0) continue;
      const int x = column * kCellWidth, y = row * kCellHeight;
      if (!input.kept.meets(x, y, x + kCellWidth, y + kCellHeight)) continue;
      tile_of(tiles, scene, x, y)
          .add({x, y, std::min(x + kCellWidth, scene.width),
                std::min(y + kCellHeight, scene.height)},
               reach);
    }
  }
  sort_by_cost(tiles);
  return tiles;
}

// The taps of the farthest reach; smaller reaches need the first `count_of_reach` of them.
struct TileTaps {
  int stride;
  std::vector<TileTap> taps;
  std::vector<int> count_of_reach;
};

TileTaps make_taps(int farthest, int stride) {
  TileTaps made{stride, {}, {}};
  made.count_of_reach.assign(static_cast<std::size_t>(farthest) + 1, 0);
  for (const RingTap& tap : ring_taps(static_cast<float>(farthest + 1))) {
    made.taps.push_back({tap.dy * stride + tap.dx, tap.distance_px});
    // Ring k begins at distance k - 1/2: distances below reach + 1 lie in rings up to
    // reach + 1, whose dx and dy are at most reach + 1.
    const auto ring = static_cast<std::size_t>(tap.distance_px + 0.5f);
    for (std::size_t reach = ring > 1 ? ring - 1 : 1; reach < made.count_of_reach.size(); ++reach) {
      ++made.count_of_reach[reach];
    }
  }
  return made;
}

using Memory = std::vector<float, RowAllocator<float>>;

TilePlanes make_planes(Memory& memory, int stride, int rows) {
  // Windows and the lower of two rows may reach past the last row.
  const std::size_t length = static_cast<std::size_t>(stride) * static_cast<std::size_t>(rows + 2);
  if (memory.size() < 11 * length) memory.resize(11 * length);
  float* at = memory.data();
  return {stride, length, at, at + 4 * length, at + 8 * length, at + 9 * length, at + 10 * length};
}

struct TileFilter {
  const DofInput& input;
  Isa isa;
  const TileTaps& taps;
  int halo;  ///< pixels to the left of a tile, whole vectors
};

void filter_tile(const TileFilter& filter, const TileTask& task, const ImageView& result,
                 Memory& memory) {
  const ConstImageView& scene = filter.input.scene;
  const DofSettings& settings = filter.input.settings;
  const Area& first = task.parts.front().area;
  const int x_begin = first.x_begin / kTileWidth * kTileWidth;
  const int y_begin = first.y_begin / kTileHeight * kTileHeight;
  const int y_end = std::min(y_begin + kTileHeight, scene.height);
  const int stride = filter.taps.stride;
  const int margin = task.reach + kRingExcess;
  const TilePlanes planes = make_planes(memory, stride, y_end - y_begin + 2 * margin);
  for (int y = y_begin - margin; y < y_end + margin; ++y) {
    const auto source = row<std::uint16_t>(scene, std::clamp(y, 0, scene.height - 1));
    SOFTFOCUS_KERNEL(filter.isa, fill_tile_row)
    (planes, settings, source.data(), scene.width, x_begin - filter.halo, stride,
     static_cast<std::ptrdiff_t>(y - y_begin + margin) * stride);
  }
  for (const TileTask::Part& part : task.parts) {
    const Area& area = part.area;
    for (int y = area.y_begin; y < area.y_end; y += 2) {
      TileRows rows{area.x_begin, area.x_end, scene.width, {}, {}};
      for (int i = 0; i < 2 && y + i < area.y_end; ++i) {
        rows.from[i] = row<std::uint16_t>(scene, y + i).data();
        rows.to[i] = row<std::uint16_t>(result, y + i).data();
      }
      const auto place = static_cast<std::ptrdiff_t>(y - y_begin + margin) * stride + filter.halo +
                         (area.x_begin - x_begin);
      SOFTFOCUS_KERNEL(filter.isa, filter_tile_rows)
      (planes, place, filter.taps.taps.data(),
       filter.taps.count_of_reach[static_cast<std::size_t>(part.reach)], settings,
       filter.input.profile.half_store, rows);
    }
  }
}

void filter_tiles(const DofInput& input, const std::vector<TileTask>& tasks, int farthest,
                  const ImageView& result, ThreadPool& pool) {
  if (tasks.empty()) return;
  const int lanes = SOFTFOCUS_KERNEL(pool.isa(), kLanes);
  const int halo = (farthest + kRingExcess + lanes - 1) / lanes * lanes;
  const TileTaps taps = make_taps(farthest, halo + kTileWidth + halo + lanes);
  const TileFilter filter{input, pool.isa(), taps, halo};
  for_each_with<Memory>(pool, static_cast<int>(tasks.size()), [&](int number, auto& memory) {
    filter_tile(filter, tasks[static_cast<std::size_t>(number)], result, memory);
  });
}

void one_pass_lanes(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  const FocusMap map = pass_in_focus(input, result, pool);
  const int farthest = tap_count(*std::max_element(map.largest_px.begin(), map.largest_px.end()));
  filter_tiles(input, plan_tiles(input, map, farthest), farthest, result, pool);
}

}  // namespace

void one_pass(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  if (pool.isa() == Isa::scalar) {
    one_pass_scalar(input, result, pool);
  } else {
    one_pass_lanes(input, result, pool);
  }
}

void one_pass_blocks(const DofInput& input, std::span<const OnePassBlock> blocks,
                     const ImageView& result, ThreadPool& pool) {
  int farthest = 0;
  for (const OnePassBlock& block : blocks) farthest = std::max(farthest, block.reach);
  if (pool.isa() == Isa::scalar) return blocks_scalar(input, blocks, farthest, result, pool);
  std::vector<TileTask> tiles = tiles_of(input.scene);
  for (const OnePassBlock& block : blocks) {
    const Area area = area_of(block, input.scene);
    tile_of(tiles, input.scene, area.x_begin, area.y_begin).add(area, block.reach);
  }
  sort_by_cost(tiles);
  filter_tiles(input, tiles, farthest, result, pool);
}

}  // namespace softfocus

#else  // Rows of a tile, once a vector unit.

namespace {

#include "dof/weights.inl"

/// Doubles the windows of a row from `step` places.
template <bool largest>
SOFTFOCUS_INLINE void double_windows(float* row, int count, int step) {
  for (int x = 0; x < count; x += kLanes) {
    const Floats a = load(row + x), b = load(row + x + step);
    store(row + x, largest ? larger(a, b) : smaller(a, b));
  }
}

/// Adds the tap at a place.
template <bool leaking>
SOFTFOCUS_INLINE void add_tap(const TilePlanes& planes, std::ptrdiff_t at, float distance_px,
                              Floats receiver_leakage, Sums& sums) {
  const auto length = static_cast<std::ptrdiff_t>(planes.length);
  const float least = (leaking ? planes.least_all : planes.least)[at];
  if (least - distance_px >= 1.0f) {
    add_whole(sums, planes.whole + at, length);
  } else if (planes.most[at] > distance_px) {
    add_part<leaking>(sums, load(planes.part + at), load(planes.whole + at),
                      planes.part + at + length, length, splat(distance_px), receiver_leakage);
  }
}

/// Two receivers at a time, one below the other: their additions do not wait for each other.
template <bool leaking>
void gather_rings(const TilePlanes& planes, std::ptrdiff_t at, const TileTap* taps, int count,
                  const Floats (&leakages)[2], Sums (&sums)[2]) {
  Sums upper = sums[0], lower = sums[1];
  for (int i = 0; i < count; ++i) {
    const std::ptrdiff_t tap = at + taps[i].offset;
    add_tap<leaking>(planes, tap, taps[i].distance_px, leakages[0], upper);
    add_tap<leaking>(planes, tap + planes.stride, taps[i].distance_px, leakages[1], lower);
  }
  sums[0] = upper;
  sums[1] = lower;
}

template <HalfRounding rounding>
void store_filtered(const Sums& sums, const std::uint16_t* from, std::uint16_t* to, int x,
                    int width) {
  const HalfColour colour = resolve<rounding>(sums);
  const HalfTexels texels{colour.r, colour.g, colour.b,
                          stored_depth(load_repeating(from, x, width).a, rounding)};
  store_within(to, x, width, texels);
}

template <HalfRounding rounding>
void filter_rows(const TilePlanes& planes, std::ptrdiff_t at, const TileTap* taps, int count,
                 float leak, const TileRows& rows) {
  for (int x = rows.x_begin; x < rows.x_end; x += kLanes, at += kLanes) {
    Sums sums[2];
    Floats leakages[2];
    Mask leaks = splat(0);
    for (int i = 0; i < 2; ++i) {
      const std::ptrdiff_t centre = at + i * planes.stride;
      sums[i] = load_sums(planes.whole + centre, static_cast<std::ptrdiff_t>(planes.length));
      leakages[i] = leakage(absolute(load(planes.part + centre)), leak);
      leaks = leaks | (leakages[i] < 1.0f);
    }
    if (any(leaks)) {
      gather_rings<true>(planes, at, taps, count, leakages, sums);
    } else {
      gather_rings<false>(planes, at, taps, count, leakages, sums);
    }
    for (int i = 0; i < 2; ++i) {
      if (rows.to[i] != nullptr) {
        store_filtered<rounding>(sums[i], rows.from[i], rows.to[i], x, rows.width);
      }
    }
  }
}

}  // namespace

/// Fills a row of the planes with pixels x to x + count - 1; count is a multiple of the lanes.
/// Reads kLanes places past the end, so the last windows hold more than they should.
void fill_tile_row(const TilePlanes& planes, const DofSettings& settings, const std::uint16_t* row,
                   int width, int x, int count, std::ptrdiff_t at) {
  const auto length = static_cast<std::ptrdiff_t>(planes.length);
  for (int i = 0; i < count; i += kLanes) {
    const HalfTexels texels = load_repeating(row, x + i, width);
    const Floats radius = signed_radius(settings, half_to_float(texels.a));
    const Floats light = intensity(absolute(radius));
    const Floats r = half_to_float(texels.r), g = half_to_float(texels.g),
                 b = half_to_float(texels.b);
    float* part = planes.part + at + i;
    store(part, radius);
    store(part + length, r);
    store(part + 2 * length, g);
    store(part + 3 * length, b);
    float* whole = planes.whole + at + i;
    store(whole, light);
    store(whole + length, r * light);
    store(whole + 2 * length, g * light);
    store(whole + 3 * length, b * light);
    store(planes.least + at + i, absolute(radius));
    store(planes.least_all + at + i, select(as_ints(radius) < 0, splat(0.0f), radius));
    store(planes.most + at + i, absolute(radius));
  }
  for (int step = 1; step < kLanes; step *= 2) {
    double_windows<false>(planes.least + at, count, step);
    double_windows<false>(planes.least_all + at, count, step);
    double_windows<true>(planes.most + at, count, step);
  }
}

/// Filters two rows, of which the upper begins at `at` of the planes.
void filter_tile_rows(const TilePlanes& planes, std::ptrdiff_t at, const TileTap* taps, int count,
                      const DofSettings& settings, HalfRounding rounding, const TileRows& rows) {
  using enum HalfRounding;
  switch (rounding) {
    case nearest_even:
      return filter_rows<nearest_even>(planes, at, taps, count, settings.leak, rows);
    case toward_zero: return filter_rows<toward_zero>(planes, at, taps, count, settings.leak, rows);
    case swiftshader: return filter_rows<swiftshader>(planes, at, taps, count, settings.leak, rows);
  }
}

#endif

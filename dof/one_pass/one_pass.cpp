#ifndef SOFTFOCUS_ISA

#include "dof/one_pass/one_pass.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "dof/focus_map.h"
#include "dof/weights.h"
#include "raster/passes/fullscreen_pass.h"
#include "raster/threads/scratch_shelf.h"

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

// --- oracle: as a fragment shader would be written ---

void one_pass_oracle(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  const ConstImageView& scene = input.scene;
  const auto fetch = [&](int x, int y) {
    return load_texel<Format::rgba16f>(scene, std::clamp(x, 0, scene.width - 1),
                                       std::clamp(y, 0, scene.height - 1));
  };
  const auto neighbour = [&](int x, int y) {
    const glm::vec4 texel = fetch(x, y);
    return filter_texel(input.settings, glm::vec3{texel.x, texel.y, texel.z}, texel.w);
  };
  const std::vector<RingTap> taps = ring_taps(input.settings.max_coc_px);
  fullscreen_pass<Format::rgba16f>(result, input.profile, pool, [&](int x, int y) {
    const FilterTexel centre = neighbour(x, y);
    const float receiver_leakage = leakage(centre.radius_px, input.settings.leak);
    Gather gather = begin_gather(centre);
    for (const RingTap& tap : taps) {
      add_neighbour(gather, neighbour(x + tap.dx, y + tap.dy), tap.distance_px, receiver_leakage);
    }
    return glm::vec4{resolve(gather), fetch(x, y).w};
  });
}

// --- scalar: bands of rows, each pixel's radius and intensity computed once ---

namespace {

constexpr int kBandRows = 32;

// Rows y_begin - margin to y_end + margin - 1 as filter texels, and `margin` texels on either
// side. The picture's edge repeats outwards.
struct Band {
  int margin;
  int y_begin;
  int stride;
  std::vector<FilterTexel> texels;

  const FilterTexel* at(int x, int y) const {
    return &texels[static_cast<std::size_t>((y - y_begin + margin) * stride + x + margin)];
  }
};

Band fill_band(const DofInput& input, int y_begin, int y_end, int margin) {
  const ConstImageView& scene = input.scene;
  Band band{margin, y_begin, scene.width + 2 * margin, {}};
  const int rows = y_end - y_begin + 2 * margin;
  band.texels.resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(band.stride));
  std::size_t next = 0;
  for (int y = y_begin - margin; y < y_end + margin; ++y) {
    const int inside_y = std::clamp(y, 0, scene.height - 1);
    for (int x = -margin; x < scene.width + margin; ++x) {
      const glm::vec4 texel =
          load_texel<Format::rgba16f>(scene, std::clamp(x, 0, scene.width - 1), inside_y);
      band.texels[next++] =
          filter_texel(input.settings, glm::vec3{texel.x, texel.y, texel.z}, texel.w);
    }
  }
  return band;
}

void one_pass_scalar(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  const ConstImageView& scene = input.scene;
  const float radius = largest_filter_radius(input, pool);
  const std::vector<RingTap> taps = ring_taps(radius);

  pool.for_each((scene.height + kBandRows - 1) / kBandRows, [&](int number) {
    const int y_begin = number * kBandRows;
    const int y_end = std::min(y_begin + kBandRows, scene.height);
    const Band band = fill_band(input, y_begin, y_end, tap_count(radius));
    for (int y = y_begin; y < y_end; ++y) {
      for (int x = 0; x < scene.width; ++x) {
        const FilterTexel* centre = band.at(x, y);
        const float receiver_leakage = leakage(centre->radius_px, input.settings.leak);
        Gather gather = begin_gather(*centre);
        for (const RingTap& tap : taps) {
          add_neighbour(gather, *(centre + tap.dy * band.stride + tap.dx), tap.distance_px,
                        receiver_leakage);
        }
        const float depth = load_texel<Format::rgba16f>(scene, x, y).w;
        store_texel<Format::rgba16f>(result, x, y, glm::vec4{resolve(gather), depth},
                                     input.profile);
      }
    }
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

// The cells of a tile that need the filter, and how far their taps go.
struct TileTask {
  struct Cell {
    int column, row, reach;
  };
  std::vector<Cell> cells;
  int reach = 0;
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
std::vector<TileTask> plan_tiles(const FocusMap& map, int farthest) {
  constexpr int kColumns = kTileWidth / kCellWidth, kRows = kTileHeight / kCellHeight;
  const int across = (map.columns + kColumns - 1) / kColumns;
  const int down = (map.rows + kRows - 1) / kRows;
  std::vector<TileTask> tasks;
  for (int tile = 0; tile < across * down; ++tile) {
    TileTask task;
    for (int i = 0; i < kColumns * kRows; ++i) {
      const int column = tile % across * kColumns + i % kColumns;
      const int row = tile / across * kRows + i / kColumns;
      if (column >= map.columns || row >= map.rows) continue;
      const int reach = reach_of_cell(map, column, row, farthest);
      if (reach > 0) task.cells.push_back({column, row, reach});
      task.reach = std::max(task.reach, reach);
    }
    if (task.reach > 0) tasks.push_back(std::move(task));
  }
  std::stable_sort(tasks.begin(), tasks.end(),
                   [](const TileTask& a, const TileTask& b) { return a.reach > b.reach; });
  return tasks;
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
  const int x_begin = task.cells.front().column * kCellWidth / kTileWidth * kTileWidth;
  const int y_begin = task.cells.front().row * kCellHeight / kTileHeight * kTileHeight;
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
  for (const TileTask::Cell& cell : task.cells) {
    const int x = cell.column * kCellWidth;
    const int cell_end = std::min((cell.row + 1) * kCellHeight, scene.height);
    for (int y = cell.row * kCellHeight; y < cell_end; y += 2) {
      TileRows rows{x, std::min(x + kCellWidth, scene.width), scene.width, {}, {}};
      for (int i = 0; i < 2 && y + i < cell_end; ++i) {
        rows.from[i] = row<std::uint16_t>(scene, y + i).data();
        rows.to[i] = row<std::uint16_t>(result, y + i).data();
      }
      const auto place =
          static_cast<std::ptrdiff_t>(y - y_begin + margin) * stride + filter.halo + (x - x_begin);
      SOFTFOCUS_KERNEL(filter.isa, filter_tile_rows)
      (planes, place, filter.taps.taps.data(),
       filter.taps.count_of_reach[static_cast<std::size_t>(cell.reach)], settings,
       filter.input.profile.half_store, rows);
    }
  }
}

void one_pass_lanes(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  const FocusMap map = pass_in_focus(input, result, pool);
  const int farthest = tap_count(*std::max_element(map.largest_px.begin(), map.largest_px.end()));
  const std::vector<TileTask> tasks = plan_tiles(map, farthest);
  if (tasks.empty()) return;
  const int lanes = SOFTFOCUS_KERNEL(pool.isa(), kLanes);
  const int halo = (farthest + kRingExcess + lanes - 1) / lanes * lanes;
  const TileTaps taps = make_taps(farthest, halo + kTileWidth + halo + lanes);
  const TileFilter filter{input, pool.isa(), taps, halo};
  ScratchShelf<Memory> shelf;
  pool.for_each(static_cast<int>(tasks.size()), [&](int number) {
    Memory memory = shelf.take();
    filter_tile(filter, tasks[static_cast<std::size_t>(number)], result, memory);
    shelf.put_back(std::move(memory));
  });
}

}  // namespace

void one_pass(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  if (pool.isa() == Isa::scalar) {
    one_pass_scalar(input, result, pool);
  } else {
    one_pass_lanes(input, result, pool);
  }
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
                          stored_depth(load_repeating(from, x, width).a)};
  if (x + kLanes <= width) return store_half_texels(to + 4 * x, texels);
  std::uint16_t last[4 * kLanes];
  store_half_texels(last, texels);
  std::memcpy(to + 4 * x, last, 4 * sizeof *last * static_cast<std::size_t>(width - x));
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
  if (rounding == HalfRounding::nearest_even) {
    filter_rows<HalfRounding::nearest_even>(planes, at, taps, count, settings.leak, rows);
  } else {
    filter_rows<HalfRounding::toward_zero>(planes, at, taps, count, settings.leak, rows);
  }
}

#endif

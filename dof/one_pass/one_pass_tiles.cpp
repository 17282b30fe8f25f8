#include "dof/one_pass/one_pass_tiles.h"

#include <algorithm>
#include <vector>

#include "dof/focus_map.h"
#include "dof/one_pass/one_pass.h"
#include "raster/threads/scratch_shelf.h"
#include "dof/weights.h"
#include "raster/images/image.h"

#define SOFTFOCUS_KERNELS "dof/one_pass/one_pass_kernels.inl"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

constexpr int kTileWidth = 2 * kCellWidth;
constexpr int kTileHeight = 2 * kCellHeight;

// Taps are taken in whole rings, the last of which goes farther than the reach by this.
constexpr int kRingExcess = 1;

/// Cells of one tile to be filtered, and how far their taps reach.
struct TileTask {
  struct Cell {
    int column, row, reach;
  };
  std::vector<Cell> cells;
  int reach = 0;
};

// How far the pixels reach that reach a cell; 0 where nothing is to be done.
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

// The costliest first, so that threads end together.
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
  std::ranges::stable_sort(tasks, std::ranges::greater{}, &TileTask::reach);
  return tasks;
}

// The taps of the farthest reach, and how many of them lesser reaches need.
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
    // A ring k begins at the distance k - 1/2: distances below reach + 1 lie in rings up
    // to reach + 1, in which dx and dy are no larger.
    const auto ring = static_cast<std::size_t>(tap.distance_px + 0.5f);
    for (std::size_t reach = ring > 1 ? ring - 1 : 1; reach < made.count_of_reach.size(); ++reach) {
      ++made.count_of_reach[reach];
    }
  }
  return made;
}

using Memory = std::vector<float, RowAllocator<float>>;

TilePlanes make_planes(Memory& memory, int stride, int rows) {
  // Past the last row, windows and vectors of the row that is not there.
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

void filter_tile(const TileFilter& filter, const TileTask& task, const ImageView& result, Memory& memory) {
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

}  // namespace

void one_pass_tiles(const DofInput& input, const ImageView& result, ThreadPool& pool) {
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

}  // namespace softfocus

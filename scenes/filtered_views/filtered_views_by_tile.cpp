#include "scenes/filtered_views/filtered_views_by_tile.h"

#include <algorithm>
#include <array>
#include <vector>

#include "scenes/lens_views/sample_sums.h"
#include "scenes/lens_views/samples_by_tile.h"
#include "scenes/lens_views/tile_difference.h"

namespace softfocus {
namespace {

static_assert(kFirstTileViews <= kSampleGroup);
static_assert(kMostSpreadStep <= kSpreadTile);

std::vector<int> tiles_with(std::span<const int> counts, int views) {
  std::vector<int> tiles;
  for (std::size_t tile = 0; tile < counts.size(); ++tile) {
    if (counts[tile] == views) tiles.push_back(static_cast<int>(tile));
  }
  return tiles;
}

// The tiles and those around them.
std::vector<int> with_neighbours(std::span<const int> tiles, int tiles_x, int tile_count) {
  std::vector<int> all;
  for (const int tile : tiles) {
    const int x = tile % tiles_x;
    for (int row = -1; row <= 1; ++row) {
      for (int column = std::max(x - 1, 0); column <= std::min(x + 1, tiles_x - 1); ++column) {
        const int neighbour = tile + row * tiles_x + column - x;
        if (neighbour >= 0 && neighbour < tile_count) all.push_back(neighbour);
      }
    }
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

// The number of each tile's views, by those that are drawn.
std::vector<int> wanted_views(const FilteredViewsBuffer& buffer, std::span<const int> sizes,
                              ThreadPool& pool) {
  const TileLists& lists = buffer.views.tile_lists[0];
  std::vector<int> counts(static_cast<std::size_t>(tile_count(lists)));
  const std::size_t first = buffer.cells.views.size();
  pool.for_each(tile_count(lists), [&](int tile) {
    std::array<const std::uint16_t*, kFirstTileViews> views{};
    for (std::size_t i = 0; i < first; ++i) views[i] = texels_of_tile(buffer.pictures[i], tile);
    const Rectangle area = tile_area(lists, tile);
    const int pixels = (area.x_end - area.x_begin) * (area.y_end - area.y_begin);
    counts[static_cast<std::size_t>(tile)] =
        tile_samples(squared_difference({views.data(), first}, pixels), pixels, sizes);
  });
  return counts;
}

void add_views_of_tiles(FilteredViewsBuffer& buffer, const LensViewInput& input, int views,
                        std::span<const int> tiles, SampleSums& sums, ThreadPool& pool) {
  set_views(buffer, input, views);
  const bool plain = buffer.cells.per_cell == 1;
  const int step = plain ? kLensViewGroup : kSampleGroup;
  const std::vector<int> drawn =
      with_neighbours(tiles, sums.tiles_x, static_cast<int>(sums.tile_counts.size()));
  for (int begin = 0; begin < views; begin += step) {
    const int end = std::min(begin + step, views);
    if (plain) {
      add_lens_views(buffer.views, input, begin, end, sums, pool, tiles);
    } else {
      draw_views(buffer, input, begin, end, drawn, pool);
      spread_views(buffer, begin, end, tiles, sums, pool);
    }
    if (input.progress) input.progress(end);
  }
}

}  // namespace

SampledPicture filtered_views_by_tile(FilteredViewsBuffer& buffer, const LensViewInput& input,
                                      ThreadPool& pool) {
  const std::vector<int> sizes = tile_sample_sizes(input.sampling.samples);
  SampleSums sums = make_sample_sums(input.pinhole.width, input.pinhole.height);
  set_views(buffer, input, sizes.front());
  draw_views(buffer, input, 0, sizes.front(), {}, pool);
  sums.tile_counts = wanted_views(buffer, sizes, pool);
  for (const int size : sizes) {
    const std::vector<int> tiles = tiles_with(sums.tile_counts, size);
    if (tiles.empty()) continue;
    if (size == sizes.front()) {
      spread_views(buffer, 0, size, tiles, sums, pool);
    } else {
      add_views_of_tiles(buffer, input, size, tiles, sums, pool);
    }
  }
  return picture_by_tile(sums, input, pool);
}

}  // namespace softfocus

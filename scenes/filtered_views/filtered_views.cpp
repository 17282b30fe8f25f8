#include "scenes/filtered_views/filtered_views.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "raster/threads/loops.h"
#include "scenes/lens_views/sample_sums.h"
#include "scenes/lens_views/samples_by_tile.h"

namespace softfocus {
namespace {

// Views that are held against twice as many.
constexpr int kFewestViews = 8;

void draw_tile_of_views(FilteredViewsBuffer& buffer, int tile, std::size_t count,
                        TileMemory& memory, Isa isa) {
  for (std::size_t i = 0; i < count; ++i) {
    ViewTiles& picture = buffer.pictures[i];
    draw_view_tile(buffer.views, i, tile, memory,
                   reinterpret_cast<std::byte*>(texels_of_tile(picture, tile)));
    set_levels(picture, buffer.spread, tile, isa);
  }
}

void add_tile_sums(const SpreadMemory& memory, const Rectangle& area, SampleSums& sums) {
  constexpr std::size_t kPlane = std::size_t{kSpreadTile} * kSpreadTile;
  for (int y = area.y_begin; y < area.y_end; ++y) {
    const float* from = memory.sums.get() + (y - area.y_begin) * std::ptrdiff_t{kSpreadTile};
    double* to = sums_at(sums, area.x_begin, y);
    for (int x = area.x_begin; x < area.x_end; ++x, ++from, to += 4) {
      to[0] += static_cast<double>(from[0]);
      to[1] += static_cast<double>(from[kPlane]);
      to[2] += static_cast<double>(from[2 * kPlane]);
    }
  }
}

SampledPicture picture_of_sums(const SampleSums& sums, const LensViewInput& input,
                               ThreadPool& pool) {
  return {mean_picture(sums, input.pinhole, input.profile, pool), sums.count, {}, {}};
}

}  // namespace

PixelCoc coc_of(const LensViewInput& input) {
  const double px_per_unit = input.camera.eye_to_clip[0][0] * input.pinhole.width / 2.0;
  return {static_cast<float>(input.aperture_radius_m / input.focus_m * px_per_unit),
          static_cast<float>(input.focus_m)};
}

void set_views(FilteredViewsBuffer& buffer, const LensViewInput& input, int views) {
  const Sampling& sampling = input.sampling;
  const PixelCoc coc = coc_of(input);
  // To frames of one lens the cells are the same.
  const bool same_cells = buffer.cells.views.size() == static_cast<std::size_t>(views) &&
                          buffer.aperture == sampling.aperture && buffer.jitter == sampling.jitter;
  if (!same_cells) {
    buffer.aperture = sampling.aperture;
    buffer.jitter = sampling.jitter;
    buffer.cells = lens_cells(sampling.aperture, views, points_of_cell(views), sampling.jitter);
  }
  if (!same_cells || buffer.spread.coc != coc) buffer.spread = make_view_spread(coc, buffer.cells);
  buffer.views.points = buffer.cells.views;
  buffer.views.offsets = buffer.cells.in_pixel;
}

FilteredViewsBuffer make_filtered_views_buffer(const LensViewInput& input, ThreadPool& pool) {
  return {make_accumulation_buffer(input, pool),
          {},
          false,
          {},
          {},
          {},
          make_sample_sums(input.pinhole.width, input.pinhole.height)};
}

void draw_views(FilteredViewsBuffer& buffer, const LensViewInput& input, int begin, int end,
                std::span<const int> tiles, ThreadPool& pool) {
  const auto count = static_cast<std::size_t>(end - begin);
  sort_lens_views(buffer.views, input, begin, end, pool);
  while (buffer.pictures.size() < count) {
    buffer.pictures.push_back(make_view_tiles(input.pinhole.width, input.pinhole.height));
  }
  const int drawn =
      tiles.empty() ? tile_count(buffer.views.tile_lists[0]) : static_cast<int>(tiles.size());
  for_each_with<TileMemory>(pool, drawn, [&](int number, auto& memory) {
    const int tile = tiles.empty() ? number : tiles[static_cast<std::size_t>(number)];
    draw_tile_of_views(buffer, tile, count, memory, pool.isa());
  });
  clear_lens_views(buffer.views);
}

void spread_views(const FilteredViewsBuffer& buffer, int begin, int end, std::span<const int> tiles,
                  SampleSums& sums, ThreadPool& pool) {
  std::vector<SpreadSteps> steps;
  for (int view = begin; view < end; ++view) {
    steps.push_back(spread_steps(buffer.spread, points_of(buffer.cells, view),
                                 buffer.cells.in_pixel[static_cast<std::size_t>(view)]));
  }
  const TileLists& lists = buffer.views.tile_lists[0];
  const int spread = tiles.empty() ? tile_count(lists) : static_cast<int>(tiles.size());
  for_each_with<SpreadMemory>(pool, spread, [&](int number, auto& memory) {
    if (!memory.sums) memory = make_spread_memory();
    const int tile = tiles.empty() ? number : tiles[static_cast<std::size_t>(number)];
    for (std::size_t i = 0; i < steps.size(); ++i) {
      spread_tile(buffer.pictures[i], steps[i], tile, i == 0, memory, pool.isa());
    }
    add_tile_sums(memory, tile_area(lists, tile), sums);
  });
  sums.count += end - begin;
}

void add_filtered_views(FilteredViewsBuffer& buffer, const LensViewInput& input, SampleSums& sums,
                        ThreadPool& pool) {
  const int views = static_cast<int>(buffer.cells.views.size());
  const bool plain = buffer.cells.per_cell == 1;
  const int step = plain ? kLensViewGroup : kSampleGroup;
  for (int begin = sums.count; begin < views; begin += step) {
    const int end = std::min(begin + step, views);
    if (plain) {
      add_lens_views(buffer.views, input, begin, end, sums, pool);
    } else {
      draw_views(buffer, input, begin, end, {}, pool);
      spread_views(buffer, begin, end, {}, sums, pool);
    }
    if (input.progress) input.progress(sums.count);
  }
}

SampledPicture filtered_views(const LensViewInput& input, ThreadPool& pool) {
  LensViewMemory own;
  std::shared_ptr<FilteredViewsBuffer>& buffer =
      (input.memory != nullptr ? *input.memory : own).filtered_views;
  if (!buffer) {
    buffer = std::make_shared<FilteredViewsBuffer>(make_filtered_views_buffer(input, pool));
  }
  return filtered_views(*buffer, input, pool);
}

SampledPicture filtered_views(FilteredViewsBuffer& buffer, const LensViewInput& input,
                              ThreadPool& pool) {
  const Sampling& sampling = input.sampling;
  if (sampling.by_tile) return filtered_views_by_tile(buffer, input, pool);
  SampleSums& sums = input.begun != nullptr ? *input.begun : buffer.sums;
  if (input.begun == nullptr) {
    clear_sums(sums);
  } else if (sums.count == 0) {
    sums = make_sample_sums(input.pinhole.width, input.pinhole.height);
  }
  if (!sampling.until) {
    set_views(buffer, input, sampling.samples);
    add_filtered_views(buffer, input, sums, pool);
    return picture_of_sums(sums, input, pool);
  }
  SampleSums of_half;
  std::optional<double> apart;
  for (int views = std::min(kFewestViews, sampling.samples);;) {
    set_views(buffer, input, views);
    clear_sums(sums);
    add_filtered_views(buffer, input, sums, pool);
    if (2 * of_half.count == views && of_half.count > 0) apart = rms_between(of_half, sums, pool);
    if ((apart && *apart <= *sampling.until) || views == sampling.samples) break;
    of_half = sums;
    views = std::min(2 * views, sampling.samples);
  }
  SampledPicture result = picture_of_sums(sums, input, pool);
  result.half_set_rms = apart;
  return result;
}

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

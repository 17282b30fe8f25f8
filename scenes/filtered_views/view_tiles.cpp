#ifndef SOFTFOCUS_ISA

#include "scenes/filtered_views/view_tiles.h"

#include <algorithm>

#include "raster/images/texel.h"

#define SOFTFOCUS_KERNELS "scenes/filtered_views/view_tiles.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

constexpr std::size_t kViewTexelHalves = 4;
constexpr std::size_t kViewTileHalves = kViewTexelHalves * kSpreadTile * kSpreadTile;

}  // namespace

int tile_width(const ViewTiles& view, int tile_x) {
  return std::min(kSpreadTile, view.width - tile_x * kSpreadTile);
}
int tile_height(const ViewTiles& view, int tile_y) {
  return std::min(kSpreadTile, view.height - tile_y * kSpreadTile);
}

ViewTiles make_view_tiles(int width, int height) {
  ViewTiles view{width,
                 height,
                 (width + kSpreadTile - 1) / kSpreadTile,
                 (height + kSpreadTile - 1) / kSpreadTile,
                 {},
                 {}};
  const auto tiles =
      static_cast<std::size_t>(view.tiles_x) * static_cast<std::size_t>(view.tiles_y);
  view.halves = make_row_memory<std::uint16_t>((tiles + 1) * kViewTileHalves);
  view.levels.resize(tiles);
  return view;
}

std::uint16_t* texels_of_tile(const ViewTiles& view, int tile) {
  return view.halves.get() + static_cast<std::size_t>(tile) * kViewTileHalves;
}

void set_levels(ViewTiles& view, const ViewSpread& spread, int tile, Isa isa) {
  const int pixels = tile_width(view, tile % view.tiles_x) * tile_height(view, tile / view.tiles_x);
  std::uint16_t* texels = texels_of_tile(view, tile);
  ViewTiles::Levels found{kSpreadLevels, 0};
  int done = 0;
  if (isa != Isa::scalar) {
    done = SOFTFOCUS_KERNEL(isa, set_levels)(spread, pixels, texels, found.nearest, found.farthest);
  }
  for (int i = done; i < pixels; ++i) {
    std::uint16_t& alpha = texels[kViewTexelHalves * static_cast<std::size_t>(i) + 3];
    alpha =
        static_cast<std::uint16_t>(spread_level(spread, half_to_float(alpha)) + kMostSpreadLevel);
    found.nearest = std::min(found.nearest, alpha);
    found.farthest = std::max(found.farthest, alpha);
  }
  view.levels[static_cast<std::size_t>(tile)] = found;
}

}  // namespace softfocus

#else  // kernels

namespace {

SOFTFOCUS_INLINE Ints levels_of(const ViewSpread& spread, Floats depth_m) {
  constexpr float kLast = kMostSpreadLevel;
  const Floats radius = spread.coc.radius_at_infinity_px * (depth_m - spread.coc.focus_m);
  Floats level = spread.levels_per_px * radius / (depth_m + spread.bend_per_px * absolute(radius));
  level = smaller(level, splat(kLast));
  level = larger(level, splat(-kLast));
  return truncate(floor(level + 0.5f)) + kMostSpreadLevel;
}

}  // namespace

/// Returns how many pixels are done.
int set_levels(const ViewSpread& spread, int count, std::uint16_t* texels, std::uint16_t& nearest,
               std::uint16_t& farthest) {
  Ints least = splat(std::int32_t{nearest}), most = splat(std::int32_t{farthest});
  int done = 0;
  for (; done + kLanes <= count; done += kLanes) {
    HalfTexels loaded = load_half_texels(texels + 4 * done);
    const Ints level = levels_of(spread, half_to_float(loaded.a));
    loaded.a = as_bits(level);
    store_half_texels(texels + 4 * done, loaded);
    least = smaller(least, level);
    most = larger(most, level);
  }
  for (int i = 0; i < kLanes; ++i) {
    if (least[i] < nearest) nearest = static_cast<std::uint16_t>(least[i]);
    if (most[i] > farthest) farthest = static_cast<std::uint16_t>(most[i]);
  }
  return done;
}

#endif

#include "raster/pipeline/lanes/visibility_tile.h"

#include <cstring>

namespace softfocus {
namespace {

constexpr std::size_t kTexelBytes = bytes_per_texel(Format::rgba16f);

template <class Visit>
void for_each_pixel(const VisibilityTile& tile, const Visit& visit) {
  const Rectangle& area = tile.area;
  for (int y = 0; y < area.y_end - area.y_begin; ++y) {
    for (int x = 0; x < area.x_end - area.x_begin; ++x) visit(x, y, place_of_pixel(x, y));
  }
}

std::byte* texel_of(const TileLayer& layer, int x, int y) {
  return layer.texels + static_cast<std::size_t>(y) * layer.stride_bytes +
         static_cast<std::size_t>(x) * kTexelBytes;
}

// Texels that were there before, and that nearer triangles have moved back to this layer.
void move_back(const VisibilityTile& tile, std::size_t number) {
  const TileLayer& layer = tile.layer(number);
  for_each_pixel(tile, [&](int x, int y, std::size_t place) {
    if (layer.ids[place] >= 0) return;
    const auto before = static_cast<std::size_t>(-1 - layer.ids[place]);
    if (before == number) return;
    std::memcpy(texel_of(layer, x, y), texel_of(tile.layer(before), x, y), kTexelBytes);
  });
}

// No triangle yet: what the layers show is to be cleared, or to be kept.
void show_none(VisibilityTile& tile, bool cleared) {
  for (std::size_t i = 0; i < tile.layers; ++i) {
    const bool keeps = tile.layers > 1 && !cleared;
    tile.layer(i).ids.fill(keeps ? -1 - static_cast<std::int32_t>(i) : 0);
  }
  tile.triangles.clear();
  tile.runs.clear();
}

}  // namespace

void forget_seen(VisibilityTile& tile) { show_none(tile, false); }

void begin_tile(VisibilityTile& tile, const Rectangle& area, const RenderTargets& targets,
                std::optional<float> clear_depth) {
  tile.area = area;
  tile.layers = layer_count(targets);
  if (tile.layers > 1 && !tile.behind) tile.behind.reset(new std::array<TileLayer, kMaxLayers - 1>);
  show_none(tile, clear_depth.has_value());
  for (std::size_t i = 0; i < tile.layers; ++i) {
    TileLayer& layer = tile.layer(i);
    if (clear_depth) {
      layer.depth.fill(*clear_depth);
      continue;
    }
    const Image& from = *layer_target(targets, i).depth;
    for_each_pixel(tile, [&](int x, int y, std::size_t place) {
      layer.depth[place] =
          row<float>(from, area.y_begin + y)[static_cast<std::size_t>(area.x_begin + x)];
    });
  }
}

void clear_behind(VisibilityTile& tile, float before, float clear_depth) {
  for (std::size_t number = 1; number < tile.layers; ++number) {
    TileLayer& layer = tile.layer(number);
    for (std::size_t i = 0; i < kTilePixels; ++i) {
      const bool is_kept = tile.front.depth[i] < before;
      layer.ids[i] = is_kept ? layer.ids[i] : 0;
      layer.depth[i] = is_kept ? layer.depth[i] : clear_depth;
    }
  }
}

void end_tile(const VisibilityTile& tile, const RenderTargets& targets) {
  const Rectangle& area = tile.area;
  for (std::size_t i = 0; i < tile.layers; ++i) {
    Image& to = *layer_target(targets, i).depth;
    for_each_pixel(tile, [&](int x, int y, std::size_t place) {
      row<float>(to, area.y_begin + y)[static_cast<std::size_t>(area.x_begin + x)] =
          tile.layer(i).depth[place];
    });
  }
}

void shade_tile(const VisibilityTile& tile) {
  for (std::size_t i = tile.layers; i-- > 0;) {
    if (i > 0) move_back(tile, i);
    for (const VisibleRun& run : tile.runs) {
      run.draw->lane_steps->shade_seen(run.draw->recorded.get(), tile, i, run);
    }
  }
}

}  // namespace softfocus

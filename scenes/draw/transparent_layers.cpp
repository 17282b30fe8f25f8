#include "scenes/draw/transparent_layers.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "raster/numbers/half.h"
#include "raster/passes/over.h"
#include "scenes/scene.h"

namespace softfocus {
namespace {

// A row of a tile's layer, as lay_over() takes it.
struct LayerRow {
  std::array<std::uint16_t, 4 * kTileSize> colour, opacity;
};

// Halves of a tile's row, four a pixel.
const std::uint16_t* texels_in(const Image& image, const Rectangle& area, int y) {
  return row<std::uint16_t>(image, y).data() + 4 * area.x_begin;
}

float* depths_in(Image& image, const Rectangle& area, int y) {
  return row<float>(image, y).data() + area.x_begin;
}
const float* depths_in(const Image& image, const Rectangle& area, int y) {
  return row<float>(image, y).data() + area.x_begin;
}

int width_of(const Rectangle& area) { return area.x_end - area.x_begin; }

void split_row(const TransparentTargets& targets, std::size_t layer, const Rectangle& area, int y,
               const DepthsInMetres& in_metres, HalfRounding rounding,
               const std::uint16_t* elsewhere, Isa isa, LayerRow& split) {
  split_layer_row({texels_in(targets.colour[layer], area, y),
                   depths_in(targets.depth[layer], area, y), width_of(area)},
                  in_metres, rounding, elsewhere, split.colour.data(), split.opacity.data(), isa);
}

// Nothing, at the depths of what is opaque.
void clear_layers(const Rectangle& area, const Image& opaque_depth, TransparentTargets& targets) {
  const auto columns = static_cast<std::size_t>(width_of(area));
  for (std::size_t i = 0; i < kTransparentLayers; ++i) {
    for (int y = area.y_begin; y < area.y_end; ++y) {
      std::fill_n(row<std::uint16_t>(targets.colour[i], y).data() + 4 * area.x_begin, 4 * columns,
                  std::uint16_t{0});
      std::copy_n(depths_in(opaque_depth, area, y), columns, depths_in(targets.depth[i], area, y));
    }
  }
}

// Whether a row of a layer shows anything: nearer depths.
bool shows_in_row(const Rectangle& area, int y, const Image& opaque_depth, const Image& depth) {
  return std::memcmp(depths_in(depth, area, y), depths_in(opaque_depth, area, y),
                     sizeof(float) * static_cast<std::size_t>(width_of(area))) != 0;
}

bool shows_anything(const Rectangle& area, const Image& opaque_depth, const Image& depth) {
  for (int y = area.y_begin; y < area.y_end; ++y) {
    if (shows_in_row(area, y, opaque_depth, depth)) return true;
  }
  return false;
}

}  // namespace

TransparentTargets make_transparent_targets(int width, int height) {
  TransparentTargets targets;
  for (std::size_t i = 0; i < kTransparentLayers; ++i) {
    targets.colour[i] = make_image(Format::rgba16f, width, height);
    targets.depth[i] = make_image(Format::r32f, width, height);
  }
  return targets;
}

void set_targets(TransparentTargets& targets, RenderPass& pass) {
  pass.targets.colour[0] = &targets.colour[0];
  pass.targets.depth = &targets.depth[0];
  for (std::size_t i = 1; i < kTransparentLayers; ++i) {
    pass.targets.behind[i - 1] = {&targets.colour[i], &targets.depth[i]};
  }
}

DepthsInMetres depths_in_metres(const Camera& camera) {
  return {static_cast<float>(1.0 / camera.far_m),
          static_cast<float>(1.0 / camera.near_m - 1.0 / camera.far_m)};
}

std::size_t draw_transparent_tile(const RenderPass& pass, const TileLists& lists, int tile,
                                  const Image& opaque_depth, TransparentTargets& targets,
                                  TileMemory& memory) {
  if (work_of_tile(lists, tile).empty()) return 0;
  const Rectangle area = tile_area(lists, tile);
  clear_layers(area, opaque_depth, targets);
  draw_tile(pass, lists, tile, memory);
  std::size_t layers = 0;
  while (layers < kTransparentLayers && shows_anything(area, opaque_depth, targets.depth[layers])) {
    ++layers;
  }
  return layers;
}

void blend_transparent_tile(const TransparentTargets& targets, std::size_t layers,
                            const Image& opaque_depth, const Rectangle& area,
                            const DepthsInMetres& in_metres, const Profile& profile, Isa isa,
                            std::byte* texels, std::size_t stride_bytes) {
  if (layers == 0) return;
  LayerRow split;
  for (int y = area.y_begin; y < area.y_end; ++y, texels += stride_bytes) {
    auto* below = reinterpret_cast<std::uint16_t*>(texels);
    for (std::size_t i = layers; i-- > 0;) {
      if (!shows_in_row(area, y, opaque_depth, targets.depth[i])) continue;
      split_row(targets, i, area, y, in_metres, profile.half_store, below, isa, split);
      lay_over({split.colour.data(), split.opacity.data(), width_of(area)}, profile.half_store,
               below, isa);
      take_depths(split.opacity.data(), width_of(area), below, isa);
    }
  }
}

void store_transparent_tile(const TransparentTargets& targets, std::size_t layers,
                            const Rectangle& area, const DepthsInMetres& in_metres,
                            const Image& opaque, const Profile& profile, Isa isa,
                            std::vector<TransparentPicture>& pictures) {
  LayerRow split;
  const auto halves = 4 * static_cast<std::size_t>(width_of(area));
  const auto to = [&](Image& image, int y) {
    return row<std::uint16_t>(image, y).data() + 4 * area.x_begin;
  };
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    for (int y = area.y_begin; y < area.y_end; ++y) {
      const std::uint16_t* elsewhere = texels_in(opaque, area, y);
      if (i < layers) {
        split_row(targets, i, area, y, in_metres, profile.half_store, elsewhere, isa, split);
      } else {
        split.colour.fill(0);
        for (std::size_t at = 3; at < halves; at += 4) split.colour[at] = elsewhere[at];
        split.opacity = split.colour;
      }
      std::copy_n(split.colour.data(), halves, to(pictures[i].colour, y));
      std::copy_n(split.opacity.data(), halves, to(pictures[i].opacity, y));
    }
  }
}

Image blended(const Image& opaque, const std::vector<TransparentPicture>& layers,
              const Profile& profile, ThreadPool& pool) {
  Image picture = opaque;
  pool.for_each(picture.height, [&](int y) {
    std::uint16_t* below = row<std::uint16_t>(picture, y).data();
    for (std::size_t i = layers.size(); i-- > 0;) {
      const std::uint16_t* opacity = row<std::uint16_t>(layers[i].opacity, y).data();
      lay_over({row<std::uint16_t>(layers[i].colour, y).data(), opacity, picture.width},
               profile.half_store, below, pool.isa());
      take_depths(opacity, picture.width, below, pool.isa());
    }
  });
  return picture;
}

std::vector<TransparentLayer> views_of(const std::vector<TransparentPicture>& pictures) {
  std::vector<TransparentLayer> views;
  views.reserve(pictures.size());
  for (const TransparentPicture& picture : pictures) {
    views.push_back({picture.colour, picture.opacity});
  }
  return views;
}

}  // namespace softfocus

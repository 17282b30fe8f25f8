#include "raster/pipeline/render_pass.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <utility>

#include "raster/images/texel.h"
#include "raster/pipeline/lanes/mixed_pixels.h"
#include "raster/pipeline/lanes/rasterize_lanes.h"
#include "raster/threads/loops.h"

namespace softfocus {
namespace {

constexpr std::size_t kTargetTexelBytes = bytes_per_texel(Format::rgba16f);

// The upper left texel of an area of an RGBA16F image. AnyImage may be const.
template <class AnyImage>
auto* first_texel(AnyImage& image, const Rectangle& area, int samples = 1) {
  return image.bytes.data() +
         static_cast<std::size_t>(area.y_begin * samples) * image.stride_bytes +
         static_cast<std::size_t>(area.x_begin) * kTargetTexelBytes;
}

void clear_area(const RenderPass& pass, Image* image, const Rectangle& area, glm::vec4 value) {
  if (image == nullptr) return;
  const int rows = pass.targets.samples;  // of a row of pixels
  clear_image(*image, area.x_begin, area.y_begin * rows, area.x_end, area.y_end * rows, value,
              pass.profile);
}

void clear_targets(const RenderPass& pass, const Rectangle& area) {
  const RenderTargets& targets = pass.targets;
  if (pass.clear_colour) {
    for (Image* image : targets.colour) clear_area(pass, image, area, *pass.clear_colour);
    for (const LayerTarget& layer : targets.behind) {
      clear_area(pass, layer.colour, area, *pass.clear_colour);
    }
  }
  if (pass.clear_depth) {
    clear_area(pass, targets.depth, area, glm::vec4{*pass.clear_depth});
    for (const LayerTarget& layer : targets.behind) {
      clear_area(pass, layer.depth, area, glm::vec4{*pass.clear_depth});
    }
  }
}

// For a tile whose pixels are in the targets.
void clear_behind_in(const RenderPass& pass, const Rectangle& area, const glm::vec4& colour,
                     float depth) {
  const RenderTargets& targets = pass.targets;
  for (int y = area.y_begin; y < area.y_end; ++y) {
    const std::span<const float> nearest = row<float>(*targets.depth, y);
    for (int x = area.x_begin; x < area.x_end; ++x) {
      if (nearest[static_cast<std::size_t>(x)] < *pass.behind_before) continue;
      const Rectangle pixel{x, y, x + 1, y + 1};
      for (const LayerTarget& layer : targets.behind) {
        clear_area(pass, layer.colour, pixel, colour);
        clear_area(pass, layer.depth, pixel, glm::vec4{depth});
      }
    }
  }
}

// Of edges that are yet to be found.
void clear_coverage(const EdgeTargets& edges, const Rectangle& area) {
  for (int y = area.y_begin; y < area.y_end; ++y) {
    std::memset(row<std::uint8_t>(*edges.coverage, y - edges.y_begin).data() + area.x_begin, 0,
                static_cast<std::size_t>(area.x_end - area.x_begin));
  }
}

// Draws in lanes collect in a VisibilityTile until a scalar draw or the end comes. If they come
// first, the VisibilityTile clears: it need only clear the pixels that show no triangle.
class TileDrawing {
 public:
  /// Draws in lanes go to `texels`, or to the target if that is null.
  TileDrawing(const RenderPass& pass, const Rectangle& area, TileMemory& memory, std::byte* texels)
      : pass_(pass), area_(area), memory_(memory), texels_(texels) {}

  void draw(const TileWork& item) {
    if (item.draw->lane_steps != nullptr) {
      draw_in_lanes(item);
      return;
    }
    leave_lanes(true);
    clear();
    item.draw->scalar_steps->shade_tile(item.draw->recorded.get(), item.chunk, item.bins, area_);
  }

  void end() {
    const bool drops = pass_.behind_before && has_layers(pass_.targets);
    assert(!drops || (pass_.clear_colour && pass_.clear_depth));
    if (has_begun_ && drops) {
      softfocus::clear_behind(*memory_, *pass_.behind_before, *pass_.clear_depth);
      // Earlier triangles may have been shaded there: of these layers only what was dropped has
      // nothing to show.
      if (is_cleared_) clear_layers(memory_->layers);
    } else if (drops) {
      clear();
      clear_behind_in(pass_, area_, *pass_.clear_colour, *pass_.clear_depth);
    }
    is_last_ = true;
    leave_lanes(pass_.keep_depth);
    clear();
  }

 private:
  void draw_in_lanes(const TileWork& item) {
    if (!has_begun_) begin_lanes();
    VisibilityTile& tile = *memory_;
    if (tile.triangles.size() + item.bins.size() > kMostVisible) {
      shade();
      forget_seen(tile);
    }
    const auto first_id = static_cast<std::int32_t>(tile.triangles.size()) + 1;
    rasterize_lanes(pass_.isa, *item.lane_chunk, item.bins, *item.draw, pass_.profile, tile);
    const auto end_id = static_cast<std::int32_t>(tile.triangles.size()) + 1;
    if (!tile.runs.empty() && tile.runs.back().draw == item.draw) {
      tile.runs.back().end_id = end_id;
    } else {
      tile.runs.push_back({item.draw, first_id, end_id});
    }
  }

  void begin_lanes() {
    has_begun_ = true;
    if (!memory_) memory_.reset(new VisibilityTile);  // not zeroed: begin_tile() fills it
    begin_tile(*memory_, area_, pass_.targets, is_cleared_ ? std::nullopt : pass_.clear_depth,
               pass_.edges && !is_cleared_ ? pass_.edges->samples : 0);
    give_edges_texels();
    if (texels_ != nullptr) {
      memory_->front.texels = texels_;
      memory_->front.stride_bytes =
          kTargetTexelBytes * static_cast<std::size_t>(area_.x_end - area_.x_begin);
      return;
    }
    const auto samples = static_cast<std::size_t>(pass_.targets.samples);
    for (std::size_t i = 0; i < memory_->layers; ++i) {
      Image& target =
          *(samples > 1 ? pass_.targets.colour[0] : layer_target(pass_.targets, i).colour);
      const std::size_t sample = samples > 1 ? i : 0;
      memory_->layer(i).texels =
          first_texel(target, area_, pass_.targets.samples) + sample * target.stride_bytes;
      memory_->layer(i).stride_bytes = samples * target.stride_bytes;
    }
  }

  void give_edges_texels() {
    VisibilityTile& tile = *memory_;
    constexpr std::size_t kSampleBytes = kTilePixels * kTargetTexelBytes;
    const std::size_t bytes = tile.edge_samples * kSampleBytes;
    if (tile.edge_texels_room < bytes) {
      tile.edge_texels.reset(new std::byte[bytes]);  // not zeroed
      tile.edge_texels_room = bytes;
    }
    for (std::size_t s = 0; s < tile.edge_samples; ++s) {
      tile.layer(tile.layers + s).texels = tile.edge_texels.get() + s * kSampleBytes;
      tile.layer(tile.layers + s).stride_bytes = kTileSize * kTargetTexelBytes;
    }
  }

  void clear_layers(std::size_t layers) const {
    clear_unseen(pass_.isa, *memory_, layers, *pass_.clear_colour, pass_.profile);
  }

  void shade() {
    VisibilityTile& tile = *memory_;
    // Edges are of all triangles.
    const bool has_edges = tile.edge_samples > 0 && is_last_ && !is_cleared_;
    if (has_edges) {
      find_edge_pixels(pass_.isa, tile);
      list_edges(tile);
    }
    if (tile.has_samples) {
      find_mixed(pass_.isa, tile);
      list_further(tile);
    }
    if (!is_cleared_ && pass_.clear_colour) clear_layers(tile.layers);
    is_cleared_ = true;
    shade_tile(tile);
    if (tile.has_samples) copy_to_samples(tile);
    if (has_edges) store_edges(pass_.isa, tile, *pass_.edges, *pass_.clear_colour, pass_.profile);
  }

  void leave_lanes(bool needs_depth) {
    if (!has_begun_) return;
    shade();
    if (needs_depth) end_tile(*memory_, pass_.targets);
    has_begun_ = false;
  }

  void clear() {
    if (is_cleared_) return;
    is_cleared_ = true;
    clear_targets(pass_, area_);
  }

  const RenderPass& pass_;
  Rectangle area_;
  TileMemory& memory_;
  std::byte* texels_;
  bool is_last_ = false;  // no triangle comes after those that have been
  bool has_begun_ = false;
  bool is_cleared_ = false;
};

void draw_tile(const RenderPass& pass, const TileLists& lists, int tile, TileMemory& memory,
               std::byte* texels) {
  assert(!has_layers(pass.targets) ||
         pass.clear_colour.has_value() == pass.clear_depth.has_value());
  assert(!pass.edges || (pass.clear_colour && pass.clear_depth && pass.targets.samples == 1));
  const Rectangle area = tile_area(lists, tile);
  if (pass.edges) clear_coverage(*pass.edges, area);
  TileDrawing drawing{pass, area, memory, texels};
  const std::span<const TileWork> work = work_of_tile(lists, tile);
  for (std::size_t i = 0; i < work.size(); ++i) {
    // The next item was listed long ago, and has left the caches.
    if (i + 1 < work.size()) __builtin_prefetch(work[i + 1].bins.data());
    drawing.draw(work[i]);
  }
  drawing.end();
}

}  // namespace

Rectangle target_area(const RenderTargets& targets) {
  const Image* first = targets.depth != nullptr ? targets.depth : targets.stencil;
  for (const Image* colour : targets.colour) {
    if (colour != nullptr) first = colour;
  }
  assert(first != nullptr);
  return {0, 0, first->width, first->height / targets.samples};
}

void draw_tile(const RenderPass& pass, const TileLists& lists, int tile, TileMemory& memory) {
  draw_tile(pass, lists, tile, memory, nullptr);
}

void draw_tile_aside(const RenderPass& pass, const TileLists& lists, int tile, TileMemory& memory,
                     std::byte* texels) {
  assert(pass.clear_colour && pass.clear_depth && !has_layers(pass.targets));
  assert(pass.targets.samples == 1);
  const std::span<const TileWork> work = work_of_tile(lists, tile);
  const Rectangle area = tile_area(lists, tile);
  const int width = area.x_end - area.x_begin, height = area.y_end - area.y_begin;
  if (work.empty()) {
    if (pass.edges) clear_coverage(*pass.edges, area);
    const ImageView to = view_of(Format::rgba16f, texels, width, height);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        store_texel<Format::rgba16f>(to, x, y, *pass.clear_colour, pass.profile);
      }
    }
    return;
  }
  const bool in_lanes = std::all_of(work.begin(), work.end(), [](const TileWork& item) {
    return item.draw->lane_steps != nullptr;
  });
  if (in_lanes) {
    draw_tile(pass, lists, tile, memory, texels);
    return;
  }
  draw_tile(pass, lists, tile, memory);
  const std::size_t row_bytes = kTargetTexelBytes * static_cast<std::size_t>(width);
  const Image& target = *pass.targets.colour[0];
  const std::byte* from = first_texel(target, area);
  for (int y = area.y_begin; y < area.y_end; ++y) {
    std::memcpy(texels, from, row_bytes);
    from += target.stride_bytes;
    texels += row_bytes;
  }
}

void finish(RenderPass& pass, ThreadPool& pool) {
  TileLists lists;
  sort_into_tiles({&pass, 1}, {&lists, 1}, pool);
  for_each_with<TileMemory>(pool, tile_count(lists),
                            [&](int tile, auto& memory) { draw_tile(pass, lists, tile, memory); });
  pass.draws.clear();
}

void clear_behind(const RenderPass& pass, const glm::vec4& colour, float depth, ThreadPool& pool) {
  const Rectangle all = target_area(pass.targets);
  pool.for_each(all.y_end, [&](int y) {
    clear_behind_in(pass, {all.x_begin, y, all.x_end, y + 1}, colour, depth);
  });
}

}  // namespace softfocus

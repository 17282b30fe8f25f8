#include "raster/pipeline/render_pass.h"

#include <algorithm>
#include <cassert>
#include <memory>

#include "raster/images/texel.h"
#include "raster/pipeline/lane_kernels.h"

namespace softfocus {
namespace {

struct Batch {
  std::size_t draw;
  std::uint32_t begin;
  std::uint32_t end;
};

// Gives every draw in lanes its part of the memory, in steps of whole vectors.
void place_vertices(RenderPass& pass) {
  constexpr std::size_t kStep = 16;
  const auto room = [](const DrawCall& draw) {
    return draw.in_lanes ? (draw.vertex_count + kStep - 1) / kStep * kStep : 0;
  };
  std::size_t floats = 0, vertices = 0;
  for (const DrawCall& draw : pass.draws) {
    vertices += room(draw);
    floats += room(draw) * draw.vertex_stride;
  }
  LaneMemory& memory = pass.memory;
  if (memory.rows.size() < floats) memory.rows.resize(floats);
  if (memory.columns.size() < 3 * vertices) memory.columns.resize(3 * vertices);
  float* row = memory.rows.data();
  std::int32_t* column = memory.columns.data();
  for (const DrawCall& draw : pass.draws) {
    if (!draw.in_lanes) continue;
    draw.use_store({row, draw.vertex_stride, column, column + room(draw), column + 2 * room(draw)});
    row += room(draw) * draw.vertex_stride;
    column += 3 * room(draw);
  }
}

void shade_all_vertices(const RenderPass& pass, ThreadPool& pool) {
  std::vector<Batch> batches;
  for (std::size_t d = 0; d < pass.draws.size(); ++d) {
    const std::uint32_t count = pass.draws[d].vertex_count;
    for (std::uint32_t begin = 0; begin < count; begin += kChunkVertices) {
      batches.push_back({d, begin, std::min(begin + kChunkVertices, count)});
    }
  }
  pool.for_each(static_cast<int>(batches.size()), [&](int i) {
    const Batch& batch = batches[static_cast<std::size_t>(i)];
    pass.draws[batch.draw].shade_vertices(batch.begin, batch.end);
  });
}

// Chunks of all draws are numbered through, as LaneMemory has them.
void assemble_all_triangles(RenderPass& pass, ThreadPool& pool) {
  std::vector<Batch> chunks;
  for (std::size_t d = 0; d < pass.draws.size(); ++d) {
    for (std::uint32_t c = 0; c < pass.draws[d].chunk_count; ++c) chunks.push_back({d, c, c + 1});
  }
  if (pass.memory.chunks.size() < chunks.size()) pass.memory.chunks.resize(chunks.size());
  pool.for_each(static_cast<int>(chunks.size()), [&](int i) {
    const Batch& chunk = chunks[static_cast<std::size_t>(i)];
    const DrawCall& draw = pass.draws[chunk.draw];
    if (draw.in_lanes) {
      LaneChunk& lane_chunk = pass.memory.chunks[static_cast<std::size_t>(i)];
      clear(lane_chunk);
      draw.assemble_lanes(chunk.begin, lane_chunk);
    } else {
      draw.assemble(chunk.begin);
    }
  });
}

std::vector<std::vector<TileWork>> work_of_tiles(const RenderPass& pass, std::size_t tiles) {
  std::vector<std::vector<TileWork>> work(tiles);
  const LaneChunk* lane_chunk = pass.memory.chunks.data();
  for (const DrawCall& draw : pass.draws) {
    for (std::uint32_t c = 0; c < draw.chunk_count; ++c, ++lane_chunk) {
      if (draw.in_lanes) {
        for (const TileBins& of_tile : lane_chunk->tiles) {
          work[of_tile.tile].push_back(
              {&draw, c, lane_chunk,
               std::span{lane_chunk->bins}.subspan(of_tile.begin, of_tile.end - of_tile.begin)});
        }
        continue;
      }
      const std::span<const Bin> bins = draw.bins(c);
      for (std::size_t begin = 0; begin < bins.size();) {
        std::size_t end = begin + 1;
        while (end < bins.size() && bins[end].tile == bins[begin].tile) ++end;
        work[bins[begin].tile].push_back({&draw, c, nullptr, bins.subspan(begin, end - begin)});
        begin = end;
      }
    }
  }
  return work;
}

void clear_colours(const RenderPass& pass, const Rectangle& area) {
  if (!pass.clear_colour) return;
  for (Image* image : pass.targets.colour) {
    if (image == nullptr) continue;
    clear_image(*image, area.x_begin, area.y_begin, area.x_end, area.y_end, *pass.clear_colour,
                pass.profile);
  }
}

// Draws in lanes gather in a VisibilityTile until a draw of the other kind, or the end.
// Where they come first, clearing is left to it: most pixels are drawn over.
class TileDrawing {
 public:
  TileDrawing(const RenderPass& pass, const Rectangle& area) : pass_(pass), area_(area) {}

  void draw(const TileWork& item) {
    if (item.draw->in_lanes) {
      draw_lanes(item);
      return;
    }
    leave_lanes(true);
    clear();
    item.draw->shade_tile(item.chunk, item.bins, area_);
  }

  void end() {
    leave_lanes(pass_.keep_depth);
    clear();
  }

 private:
  void draw_lanes(const TileWork& item) {
    if (!tile_) {
      tile_.reset(new VisibilityTile);  // not zeroed: begin_tile() fills it
      begin_tile(*tile_, area_, *pass_.targets.depth,
                 is_cleared_ ? std::nullopt : pass_.clear_depth);
    }
    VisibilityTile& tile = *tile_;
    if (tile.triangles.size() + item.bins.size() > kMostVisible) {
      shade();
      forget_seen(tile);
    }
    const auto first_id = static_cast<std::int32_t>(tile.triangles.size()) + 1;
    rasterize_lanes(pass_.isa, *item.lane_chunk, item.bins, item.draw->depth, pass_.profile, tile);
    const auto end_id = static_cast<std::int32_t>(tile.triangles.size()) + 1;
    if (!tile.runs.empty() && tile.runs.back().draw == item.draw) {
      tile.runs.back().end_id = end_id;
    } else {
      tile.runs.push_back({item.draw, first_id, end_id});
    }
  }

  void shade() {
    if (!is_cleared_ && pass_.clear_colour) {
      clear_unseen(pass_.isa, *tile_, *pass_.targets.colour[0], *pass_.clear_colour, pass_.profile);
    }
    is_cleared_ = true;
    shade_tile(*tile_);
  }

  void leave_lanes(bool needs_depth) {
    if (!tile_) return;
    shade();
    if (needs_depth) end_tile(*tile_, *pass_.targets.depth);
    tile_.reset();
  }

  void clear() {
    if (is_cleared_) return;
    is_cleared_ = true;
    clear_colours(pass_, area_);
    if (pass_.clear_depth && pass_.targets.depth != nullptr) {
      clear_image(*pass_.targets.depth, area_.x_begin, area_.y_begin, area_.x_end, area_.y_end,
                  glm::vec4{*pass_.clear_depth}, pass_.profile);
    }
  }

  const RenderPass& pass_;
  Rectangle area_;
  std::unique_ptr<VisibilityTile> tile_;
  bool is_cleared_ = false;
};

}  // namespace

Rectangle target_area(const RenderTargets& targets) {
  const Image* first = targets.depth != nullptr ? targets.depth : targets.stencil;
  for (const Image* colour : targets.colour) {
    if (colour != nullptr) first = colour;
  }
  assert(first != nullptr);
  return {0, 0, first->width, first->height};
}

TileLists sort_into_tiles(RenderPass& pass, ThreadPool& pool) {
  TileLists lists;
  lists.area = target_area(pass.targets);
  lists.tiles_x = (lists.area.x_end + kTileSize - 1) / kTileSize;
  const int tiles_y = (lists.area.y_end + kTileSize - 1) / kTileSize;
  place_vertices(pass);
  shade_all_vertices(pass, pool);
  assemble_all_triangles(pass, pool);
  lists.tiles = work_of_tiles(pass, static_cast<std::size_t>(lists.tiles_x * tiles_y));
  return lists;
}

Rectangle tile_area(const TileLists& lists, int tile) {
  const int x = tile % lists.tiles_x * kTileSize;
  const int y = tile / lists.tiles_x * kTileSize;
  return {x, y, std::min(x + kTileSize, lists.area.x_end),
          std::min(y + kTileSize, lists.area.y_end)};
}

void draw_tile(const RenderPass& pass, const TileLists& lists, int tile) {
  TileDrawing drawing{pass, tile_area(lists, tile)};
  for (const TileWork& item : lists.tiles[static_cast<std::size_t>(tile)]) drawing.draw(item);
  drawing.end();
}

void finish(RenderPass& pass, ThreadPool& pool) {
  const TileLists lists = sort_into_tiles(pass, pool);
  pool.for_each(static_cast<int>(lists.tiles.size()),
                [&](int tile) { draw_tile(pass, lists, tile); });
  pass.draws.clear();
}

}  // namespace softfocus

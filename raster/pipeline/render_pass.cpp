#include "raster/pipeline/render_pass.h"

#include <algorithm>
#include <cassert>

namespace softfocus {
namespace {

struct Batch {
  std::size_t draw;
  std::uint32_t begin;
  std::uint32_t end;
};

// The triangles of one chunk that touch one tile.
struct TileWork {
  const DrawCall* draw;
  std::uint32_t chunk;
  std::span<const Bin> bins;
};

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

void assemble_all_triangles(const RenderPass& pass, ThreadPool& pool) {
  std::vector<Batch> chunks;
  for (std::size_t d = 0; d < pass.draws.size(); ++d) {
    for (std::uint32_t c = 0; c < pass.draws[d].chunk_count; ++c) chunks.push_back({d, c, c + 1});
  }
  pool.for_each(static_cast<int>(chunks.size()), [&](int i) {
    const Batch& chunk = chunks[static_cast<std::size_t>(i)];
    pass.draws[chunk.draw].assemble(chunk.begin);
  });
}

std::vector<std::vector<TileWork>> sort_into_tiles(const RenderPass& pass, std::size_t tiles) {
  std::vector<std::vector<TileWork>> work(tiles);
  for (const DrawCall& draw : pass.draws) {
    for (std::uint32_t c = 0; c < draw.chunk_count; ++c) {
      const std::span<const Bin> bins = draw.bins(c);
      for (std::size_t begin = 0; begin < bins.size();) {
        std::size_t end = begin + 1;
        while (end < bins.size() && bins[end].tile == bins[begin].tile) ++end;
        work[bins[begin].tile].push_back({&draw, c, bins.subspan(begin, end - begin)});
        begin = end;
      }
    }
  }
  return work;
}

}  // namespace

Rectangle target_area(const RenderTargets& targets) {
  const Image* first = targets.depth != nullptr ? targets.depth : targets.stencil;
  for (const Image* colour : targets.colour) {
    if (colour != nullptr) first = colour;
  }
  assert(first != nullptr);
  return {0, 0, first->width, first->height};
}

void finish(RenderPass& pass, ThreadPool& pool) {
  const Rectangle area = target_area(pass.targets);
  const int tiles_x = (area.x_end + kTileSize - 1) / kTileSize;
  const int tiles_y = (area.y_end + kTileSize - 1) / kTileSize;

  shade_all_vertices(pass, pool);
  assemble_all_triangles(pass, pool);
  const auto work = sort_into_tiles(pass, static_cast<std::size_t>(tiles_x * tiles_y));
  pool.for_each(tiles_x * tiles_y, [&](int t) {
    const int x = t % tiles_x * kTileSize;
    const int y = t / tiles_x * kTileSize;
    const Rectangle tile{x, y, std::min(x + kTileSize, area.x_end),
                         std::min(y + kTileSize, area.y_end)};
    for (const TileWork& item : work[static_cast<std::size_t>(t)]) {
      item.draw->shade_tile(item.chunk, item.bins, tile);
    }
  });
  pass.draws.clear();
}

}  // namespace softfocus

#include <algorithm>
#include <cassert>
#include <utility>

#include "raster/pipeline/render_pass.h"
#include "raster/threads/loops.h"

namespace softfocus {
namespace {

// A part of a draw: some vertices, or one chunk of triangles.
struct Part {
  RenderPass* pass;
  std::size_t draw;
  std::uint32_t begin;
  std::uint32_t end;
  std::size_t lane_chunk;  // the draw's first among the chunks of all draws of the pass
};

DrawCall& draw_of(const Part& part) { return part.pass->draws[part.draw]; }

bool is_in_lanes(const DrawCall& draw) { return draw.lane_steps != nullptr; }

// A small draw takes all steps at once, while its vertices are in a core's cache.
bool is_small(const DrawCall& draw) {
  constexpr std::uint32_t kMostChunks = 4;
  return is_in_lanes(draw) && draw.vertex_count <= kChunkVertices &&
         draw.chunk_count <= kMostChunks;
}

// Vertices that its columns have room for: whole vectors.
std::size_t room(const DrawCall& draw) {
  constexpr std::size_t kStep = kMostLanes;
  return (draw.vertex_count + kStep - 1) / kStep * kStep;
}

// Columns for one small draw after the other.
struct SmallColumns {
  std::vector<std::int32_t> integers = std::vector<std::int32_t>(3 * kChunkVertices);
  std::vector<float> floats = std::vector<float>(3 * kChunkVertices);
  std::vector<std::uint8_t> used = std::vector<std::uint8_t>(kChunkVertices);
};

void use_store(const DrawCall& draw, CacheLine* rows, std::int32_t* integers, float* floats,
               std::uint8_t* used) {
  const std::size_t count = room(draw);
  draw.lane_steps->use_store(
      draw.recorded.get(),
      {rows->floats.data(), draw.vertex_stride, integers, integers + count, integers + 2 * count,
       floats, floats + count, floats + 2 * count, used});
}

// Gives each draw in lanes its rows, and its columns if it is not small.
void give_memory(RenderPass& pass) {
  std::size_t lines = 0, vertices = 0, chunks = 0;
  for (DrawCall& draw : pass.draws) {
    chunks += draw.chunk_count;
    if (!is_in_lanes(draw)) continue;
    draw.first_line = lines;
    lines += room(draw) * draw.vertex_stride / kLineFloats;
    if (!is_small(draw)) vertices += room(draw);
  }
  LaneMemory& memory = pass.memory;
  if (memory.chunks.size() < chunks) memory.chunks.resize(chunks);
  if (memory.row_lines < lines) {
    memory.rows.reset(new CacheLine[lines]);  // not zeroed, and so not in memory yet
    memory.row_lines = lines;
  }
  if (memory.used.size() < vertices) {
    memory.used.resize(vertices);
    memory.integer_columns.resize(3 * vertices);
    memory.float_columns.resize(3 * vertices);
  }
  std::size_t vertex = 0;
  for (const DrawCall& draw : pass.draws) {
    if (!is_in_lanes(draw) || is_small(draw) || draw.vertex_count == 0) continue;
    use_store(draw, &memory.rows[draw.first_line], &memory.integer_columns[3 * vertex],
              &memory.float_columns[3 * vertex], &memory.used[vertex]);
    vertex += room(draw);
  }
}

// The vertices, in batches, of the draws for which wanted(draw).
template <class Wanted>
std::vector<Part> vertices_of(std::span<RenderPass> passes, const Wanted& wanted) {
  std::vector<Part> parts;
  for (RenderPass& pass : passes) {
    std::size_t lane_chunk = 0;
    for (std::size_t d = 0; d < pass.draws.size(); ++d) {
      const DrawCall& draw = pass.draws[d];
      for (std::uint32_t begin = 0; wanted(draw) && begin < draw.vertex_count;
           begin += kChunkVertices) {
        const std::uint32_t end = std::min(begin + kChunkVertices, draw.vertex_count);
        parts.push_back({&pass, d, begin, end, lane_chunk});
      }
      lane_chunk += draw.chunk_count;
    }
  }
  return parts;
}

void assemble_chunk(const Part& part, std::uint32_t number) {
  const DrawCall& draw = draw_of(part);
  LaneChunk& chunk = part.pass->memory.chunks[part.lane_chunk + number];
  clear(chunk);
  draw.lane_steps->assemble(draw.recorded.get(), number, chunk);
}

// All steps of a small draw. Returns the bits that all clip codes share.
unsigned place_and_shade(const Part& part, SmallColumns& columns) {
  const DrawCall& draw = draw_of(part);
  use_store(draw, &part.pass->memory.rows[draw.first_line], columns.integers.data(),
            columns.floats.data(), columns.used.data());
  void* recorded = draw.recorded.get();
  const unsigned common = draw.lane_steps->place_vertices(recorded, part.begin, part.end);
  if (common != 0) return common;
  for (std::uint32_t c = 0; c < draw.chunk_count; ++c) assemble_chunk(part, c);
  draw.lane_steps->shade_vertices(recorded, part.begin, part.end);
  return common;
}

// Loop 1, and all steps of small draws. Finds the draws that are outside: if all vertices
// share a bit of their clip codes, no triangle is left.
void place_all_vertices(std::span<RenderPass> passes, ThreadPool& pool) {
  const std::vector<Part> parts = vertices_of(passes, [](const DrawCall&) { return true; });
  std::vector<unsigned> common_codes(parts.size());
  ScratchShelf<SmallColumns> shelf;
  pool.for_each(static_cast<int>(parts.size()), [&](int i) {
    const Part& part = parts[static_cast<std::size_t>(i)];
    unsigned& common = common_codes[static_cast<std::size_t>(i)];
    const DrawCall& draw = draw_of(part);
    if (is_small(draw)) {
      std::unique_ptr<SmallColumns> columns = shelf.take();
      common = place_and_shade(part, *columns);
      shelf.put_back(std::move(columns));
    } else if (is_in_lanes(draw)) {
      common = draw.lane_steps->place_vertices(draw.recorded.get(), part.begin, part.end);
    } else {
      draw.scalar_steps->shade_vertices(draw.recorded.get(), part.begin, part.end);
    }
  });
  for (std::size_t i = 0; i < parts.size();) {
    const DrawCall* draw = &draw_of(parts[i]);
    unsigned common = ~0u;
    for (; i < parts.size() && &draw_of(parts[i]) == draw; ++i) common &= common_codes[i];
    draw_of(parts[i - 1]).is_outside = common != 0;
  }
}

void assemble_all_triangles(std::span<RenderPass> passes, ThreadPool& pool) {
  std::vector<Part> chunks;
  for (RenderPass& pass : passes) {
    std::size_t lane_chunk = 0;
    for (std::size_t d = 0; d < pass.draws.size(); ++d) {
      const DrawCall& draw = pass.draws[d];
      for (std::uint32_t c = 0; c < draw.chunk_count; ++c) {
        if (!is_small(draw) && !draw.is_outside) chunks.push_back({&pass, d, c, c + 1, lane_chunk});
      }
      lane_chunk += draw.chunk_count;
    }
  }
  pool.for_each(static_cast<int>(chunks.size()), [&](int i) {
    const Part& chunk = chunks[static_cast<std::size_t>(i)];
    if (is_in_lanes(draw_of(chunk))) {
      assemble_chunk(chunk, chunk.begin);
    } else {
      const DrawCall& draw = draw_of(chunk);
      draw.scalar_steps->assemble(draw.recorded.get(), chunk.begin);
    }
  });
}

void shade_used_vertices(std::span<RenderPass> passes, ThreadPool& pool) {
  const std::vector<Part> parts = vertices_of(passes, [](const DrawCall& draw) {
    return is_in_lanes(draw) && !is_small(draw) && !draw.is_outside;
  });
  pool.for_each(static_cast<int>(parts.size()), [&](int i) {
    const Part& part = parts[static_cast<std::size_t>(i)];
    const DrawCall& draw = draw_of(part);
    draw.lane_steps->shade_vertices(draw.recorded.get(), part.begin, part.end);
  });
}

// Calls visit(tile, work) in the order of submission.
template <class Visit>
void for_each_work(const RenderPass& pass, const Visit& visit) {
  const LaneChunk* lane_chunk = pass.memory.chunks.data();
  for (const DrawCall& draw : pass.draws) {
    for (std::uint32_t c = 0; c < draw.chunk_count && !draw.is_outside; ++c) {
      if (is_in_lanes(draw)) {
        for (const TileBins& of_tile : lane_chunk[c].tiles) {
          visit(of_tile.tile, TileWork{&draw, c, &lane_chunk[c],
                                       std::span{lane_chunk[c].bins}.subspan(
                                           of_tile.begin, of_tile.end - of_tile.begin)});
        }
        continue;
      }
      const std::span<const Bin> bins = draw.scalar_steps->bins(draw.recorded.get(), c);
      for (std::size_t begin = 0; begin < bins.size();) {
        std::size_t end = begin + 1;
        while (end < bins.size() && bins[end].tile == bins[begin].tile) ++end;
        visit(bins[begin].tile, TileWork{&draw, c, nullptr, bins.subspan(begin, end - begin)});
        begin = end;
      }
    }
    lane_chunk += draw.chunk_count;
  }
}

void list_tiles(const RenderPass& pass, TileLists& lists) {
  lists.area = target_area(pass.targets);
  lists.tiles_x = (lists.area.x_end + kTileSize - 1) / kTileSize;
  const int tiles_y = (lists.area.y_end + kTileSize - 1) / kTileSize;
  // A counting sort. begins[i + 2] counts tile i, begins[i + 1] is where its next work goes.
  lists.begins.assign(static_cast<std::size_t>(lists.tiles_x * tiles_y) + 2, 0);
  for_each_work(pass, [&](std::uint32_t tile, const TileWork&) { ++lists.begins[tile + 2]; });
  for (std::size_t i = 2; i < lists.begins.size(); ++i) lists.begins[i] += lists.begins[i - 1];
  lists.work.resize(lists.begins.back());
  for_each_work(pass, [&](std::uint32_t tile, const TileWork& work) {
    lists.work[lists.begins[tile + 1]++] = work;
  });
  lists.begins.pop_back();
}

}  // namespace

void sort_into_tiles(std::span<RenderPass> passes, std::span<TileLists> lists, ThreadPool& pool) {
  assert(passes.size() == lists.size());
  for (RenderPass& pass : passes) give_memory(pass);
  place_all_vertices(passes, pool);
  assemble_all_triangles(passes, pool);
  shade_used_vertices(passes, pool);
  pool.for_each(static_cast<int>(passes.size()), [&](int i) {
    list_tiles(passes[static_cast<std::size_t>(i)], lists[static_cast<std::size_t>(i)]);
  });
}

int tile_count(const TileLists& lists) { return static_cast<int>(lists.begins.size()) - 1; }

std::span<const TileWork> work_of_tile(const TileLists& lists, int tile) {
  const auto i = static_cast<std::size_t>(tile);
  return std::span{lists.work}.subspan(lists.begins[i], lists.begins[i + 1] - lists.begins[i]);
}

Rectangle tile_area(const TileLists& lists, int tile) {
  const int x = tile % lists.tiles_x * kTileSize;
  const int y = tile / lists.tiles_x * kTileSize;
  return {x, y, std::min(x + kTileSize, lists.area.x_end),
          std::min(y + kTileSize, lists.area.y_end)};
}

}  // namespace softfocus

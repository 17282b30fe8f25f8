#include <algorithm>
#include <cassert>

#include "raster/pipeline/render_pass.h"

namespace softfocus {
namespace {

// A part of a draw: vertices, or one chunk of triangles.
struct Part {
  RenderPass* pass;
  std::size_t draw;
  std::uint32_t begin;
  std::uint32_t end;
  std::size_t lane_chunk = 0;  // chunks of all draws of a pass are numbered through
};

// Gives every draw in lanes its part of the memory, in steps of whole vectors.
void give_memory(RenderPass& pass) {
  constexpr std::size_t kStep = 16;
  const auto room = [](const DrawCall& draw) {
    return draw.lane_steps != nullptr ? (draw.vertex_count + kStep - 1) / kStep * kStep : 0;
  };
  std::size_t lines = 0, vertices = 0;
  for (const DrawCall& draw : pass.draws) {
    vertices += room(draw);
    lines += room(draw) * draw.vertex_stride / kLineFloats;
  }
  LaneMemory& memory = pass.memory;
  if (memory.rows.size() < lines) memory.rows.resize(lines);
  if (memory.used.size() < vertices) {
    memory.used.resize(vertices);
    memory.integer_columns.resize(3 * vertices);
    memory.float_columns.resize(3 * vertices);
  }
  std::size_t line = 0, vertex = 0;
  for (const DrawCall& draw : pass.draws) {
    const std::size_t count = room(draw);
    if (count == 0) continue;
    std::int32_t* integers = &memory.integer_columns[3 * vertex];
    float* floats = &memory.float_columns[3 * vertex];
    draw.lane_steps->use_store(
        draw.lane_draw.get(),
        {memory.rows[line].floats.data(), draw.vertex_stride, integers, integers + count,
         integers + 2 * count, floats, floats + count, floats + 2 * count, &memory.used[vertex]});
    line += count * draw.vertex_stride / kLineFloats;
    vertex += count;
  }
}

std::vector<Part> vertices_of(std::span<RenderPass> passes) {
  std::vector<Part> parts;
  for (RenderPass& pass : passes) {
    for (std::size_t d = 0; d < pass.draws.size(); ++d) {
      if (pass.draws[d].is_outside) continue;
      const std::uint32_t count = pass.draws[d].vertex_count;
      for (std::uint32_t begin = 0; begin < count; begin += kChunkVertices) {
        parts.push_back({&pass, d, begin, std::min(begin + kChunkVertices, count)});
      }
    }
  }
  return parts;
}

// Of draws in lanes the positions alone. Finds the draws that are outside.
void place_all_vertices(std::span<RenderPass> passes, ThreadPool& pool) {
  const std::vector<Part> parts = vertices_of(passes);
  std::vector<unsigned> common_codes(parts.size());
  pool.for_each(static_cast<int>(parts.size()), [&](int i) {
    const Part& part = parts[static_cast<std::size_t>(i)];
    const DrawCall& draw = part.pass->draws[part.draw];
    if (draw.lane_steps == nullptr) {
      draw.shade_vertices(part.begin, part.end);
    } else {
      common_codes[static_cast<std::size_t>(i)] =
          draw.lane_steps->place_vertices(draw.lane_draw.get(), part.begin, part.end);
    }
  });
  for (std::size_t i = 0; i < parts.size();) {
    unsigned common = ~0u;
    const std::size_t first = i;
    const auto is_same_draw = [&] {
      return i < parts.size() && parts[i].pass == parts[first].pass &&
             parts[i].draw == parts[first].draw;
    };
    for (; is_same_draw(); ++i) common &= common_codes[i];
    parts[first].pass->draws[parts[first].draw].is_outside = common != 0;
  }
}

void assemble_all_triangles(std::span<RenderPass> passes, ThreadPool& pool) {
  std::vector<Part> chunks;
  for (RenderPass& pass : passes) {
    std::size_t lane_chunk = 0;
    for (std::size_t d = 0; d < pass.draws.size(); ++d) {
      const DrawCall& draw = pass.draws[d];
      for (std::uint32_t c = 0; c < draw.chunk_count && !draw.is_outside; ++c) {
        chunks.push_back({&pass, d, c, c + 1, lane_chunk + c});
      }
      lane_chunk += draw.chunk_count;
    }
    if (pass.memory.chunks.size() < lane_chunk) pass.memory.chunks.resize(lane_chunk);
  }
  pool.for_each(static_cast<int>(chunks.size()), [&](int i) {
    const Part& chunk = chunks[static_cast<std::size_t>(i)];
    const DrawCall& draw = chunk.pass->draws[chunk.draw];
    if (draw.lane_steps != nullptr) {
      LaneChunk& lane_chunk = chunk.pass->memory.chunks[chunk.lane_chunk];
      clear(lane_chunk);
      draw.lane_steps->assemble(draw.lane_draw.get(), chunk.begin, lane_chunk);
    } else {
      draw.assemble(chunk.begin);
    }
  });
}

void shade_used_vertices(std::span<RenderPass> passes, ThreadPool& pool) {
  std::vector<Part> parts = vertices_of(passes);
  std::erase_if(parts,
                [](const Part& part) { return part.pass->draws[part.draw].lane_steps == nullptr; });
  pool.for_each(static_cast<int>(parts.size()), [&](int i) {
    const Part& part = parts[static_cast<std::size_t>(i)];
    const DrawCall& draw = part.pass->draws[part.draw];
    draw.lane_steps->shade_vertices(draw.lane_draw.get(), part.begin, part.end);
  });
}

// Calls visit(tile, work) in the order of submission.
template <class Visit>
void for_each_work(const RenderPass& pass, const Visit& visit) {
  const LaneChunk* lane_chunk = pass.memory.chunks.data();
  for (const DrawCall& draw : pass.draws) {
    for (std::uint32_t c = 0; c < draw.chunk_count && !draw.is_outside; ++c) {
      if (draw.lane_steps != nullptr) {
        for (const TileBins& of_tile : lane_chunk[c].tiles) {
          visit(of_tile.tile, TileWork{&draw, c, &lane_chunk[c],
                                       std::span{lane_chunk[c].bins}.subspan(
                                           of_tile.begin, of_tile.end - of_tile.begin)});
        }
        continue;
      }
      const std::span<const Bin> bins = draw.bins(c);
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

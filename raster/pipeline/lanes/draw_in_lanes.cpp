#include "raster/pipeline/lanes/draw_in_lanes.h"

#include <algorithm>

#include "raster/pipeline/setup.h"

namespace softfocus {

bool can_draw_in_lanes(const RenderPass& pass, const DrawState& state) {
  const RenderTargets& targets = pass.targets;
  const ColourState& colour = state.colour[0];
  const bool one_target = targets.colour[0] != nullptr &&
                          targets.colour[0]->format == Format::rgba16f &&
                          std::all_of(targets.colour.begin() + 1, targets.colour.end(),
                                      [](const Image* image) { return image == nullptr; });
  return pass.isa != Isa::scalar && pass.profile.coverage == Coverage::edge_functions &&
         pass.profile.attributes != AttributeSetup::planes_by_quad && one_target &&
         targets.depth != nullptr && state.depth &&
         !(state.stencil && targets.stencil != nullptr) && !state.scissor && !colour.blend &&
         !(state.alpha_to_coverage && targets.samples > 1) &&
         colour.write == std::array{true, true, true, true};
}

namespace draw_detail {
namespace {

bool any_vertex_outside(const AssembleJob& job) {
  const auto indices = job.indices.subspan(3 * job.begin, 3 * (job.end - job.begin));
  return std::any_of(indices.begin(), indices.end(), [&](std::uint32_t i) {
    return (static_cast<unsigned>(job.vertices.codes[i]) & ~kNotDrawable) != 0;
  });
}

}  // namespace

void assemble_chunk(const LaneDraw& draw, std::uint32_t number, LaneChunk& chunk,
                    AddSlowly add_slowly, const void* context) {
  const std::size_t triangle_count = draw.indices.size() / 3;
  const std::size_t chunk_begin = std::size_t{number} * kChunkTriangles;
  const std::size_t chunk_end = std::min(chunk_begin + kChunkTriangles, triangle_count);
  const DrawState& state = draw.state;
  // Mesa sends a whole batch through its clipping stages if any vertex is outside.
  const bool may_cull_unsnapped =
      state.cull != Cull::none && draw.profile.clipping == Clipping::mesa;
  for (std::size_t begin = chunk_begin; begin < chunk_end; begin += kBatchTriangles) {
    AssembleJob job{draw.store,
                    draw.indices,
                    begin,
                    std::min(begin + kBatchTriangles, chunk_end),
                    state.cull,
                    state.front_face,
                    false,
                    provoking_index(state),
                    draw.target,
                    draw.samples,
                    draw.edge_samples,
                    &draw.profile,
                    add_slowly,
                    context};
    job.cull_unsnapped = may_cull_unsnapped && any_vertex_outside(job);
    assemble_lanes(draw.isa, job, chunk);
  }
  bin_triangles(chunk, (draw.target.x_end + kTileSize - 1) / kTileSize);
}

void add_triangle(const LaneDraw& draw, LaneChunk& chunk, std::size_t number,
                  const std::array<WindowVertex, 3>& window,
                  const std::array<std::span<const float>, 3>& varyings, bool cull_unsnapped) {
  const DrawState& state = draw.state;
  if (cull_unsnapped && is_culled_unsnapped(window, state.cull, state.front_face)) return;
  const auto setup = set_up_triangle(window, state.cull, state.front_face, draw.target,
                                     draw.profile, draw.samples, draw.edge_samples);
  if (!setup) return;
  LaneTriangle& t = add_set_up_triangle(chunk, *setup, provoking_index(state), draw.profile);
  const auto indices = draw.indices.subspan(3 * number, 3);
  const bool is_whole = std::all_of(indices.begin(), indices.end(), [&](std::uint32_t index) {
    return draw.store.codes[index] == 0;
  });
  for (std::size_t i = 0; i < 3; ++i) {
    if (is_whole) {
      t.vertices[i] = draw.store.rows + indices[i] * draw.store.stride;
      mark_used(draw.store, indices[i]);
      continue;
    }
    auto& row = chunk.new_vertices.emplace_back();
    row[kVertexX] = window[i].x;
    row[kVertexY] = window[i].y;
    row[kVertexDepth] = window[i].depth;
    row[kVertexInverseW] = window[i].inverse_w;
    std::copy(varyings[i].begin(), varyings[i].end(), row.begin() + kVertexVaryings);
    t.vertices[i] = row.data();
  }
}

void record(RenderPass& pass, std::shared_ptr<void> recorded, const LaneSteps& steps,
            const LaneDraw& draw, std::uint32_t vertex_count, std::size_t varyings) {
  const auto triangles = static_cast<std::uint32_t>(draw.indices.size() / 3);
  DrawCall call;
  call.vertex_count = vertex_count;
  call.chunk_count = (triangles + kChunkTriangles - 1) / kChunkTriangles;
  call.recorded = std::move(recorded);
  call.lane_steps = &steps;
  call.vertex_stride = static_cast<std::uint32_t>(vertex_stride(varyings));
  call.depth = *draw.state.depth;
  pass.draws.push_back(std::move(call));
}

}  // namespace draw_detail
}  // namespace softfocus

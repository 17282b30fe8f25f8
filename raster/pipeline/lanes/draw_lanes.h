#pragma once
// Recording a draw for the vector kernels. Same triangles, same pixels as draw(), in
// another order of work: the vertices of many triangles at once, the edges of many, then a
// tile's depths, and last, once for each pixel, the fragment stage.

#include <cassert>
#include <memory>
#include <utility>

#include "raster/pipeline/assemble.h"
#include "raster/pipeline/lanes/lane_kernels.h"
#include "raster/pipeline/render_pass.h"
#include "raster/pipeline/setup.h"

namespace softfocus {

/// Vertices begin <= i < end of a draw. `begin` is a multiple of 16, and the store has room
/// to the next multiple past `end`.
struct VertexJob {
  VertexStore store;
  std::uint32_t begin;
  std::uint32_t end;
  int width;  ///< of the target
  int height;
  const Profile* profile;
};

/// What is seen of a draw in a tile.
struct FragmentJob {
  std::size_t provoking;
  const Profile* profile;
};

/// The stages of a draw, compiled for a vector unit (vertex_lanes.inl, shade_lanes.inl).
template <class VertexStage, class FragmentStage>
struct LaneStages {
  unsigned (*place_vertices)(const VertexStage&, const VertexJob&);
  void (*shade_vertices)(const VertexStage&, const VertexJob&);
  void (*shade_fragments)(const FragmentStage&, const FragmentJob&, const VisibilityTile&,
                          const VisibleRun&);
};

/// Whether the kernels can carry out a draw: what they leave out needs fragments in order
/// (blending, stencil), is rare (scissor, masks, several targets), or is softpipe's.
bool can_draw_in_lanes(const RenderPass& pass, const DrawState& state);

namespace draw_detail {

template <class VertexStage, class FragmentStage>
struct LaneDraw {
  static constexpr std::size_t N = FragmentStage::kInterpolation.size();

  DrawState state;
  Profile profile;
  Isa isa;
  Rectangle clip;
  std::span<const std::uint32_t> indices;
  std::uint32_t vertex_count;
  VertexStage vertex_stage;
  FragmentStage fragment_stage;
  LaneStages<VertexStage, FragmentStage> stages;
  FragmentJob fragments;
  VertexStore store;

  // A triangle that is clipped or large, by the scalar functions.
  static void add_slowly(const void* context, LaneChunk& chunk, std::size_t triangle) {
    static_cast<const LaneDraw*>(context)->add(chunk, triangle, false);
  }
  static void add_slowly_unsnapped(const void* context, LaneChunk& chunk, std::size_t triangle) {
    static_cast<const LaneDraw*>(context)->add(chunk, triangle, true);
  }

  void add(LaneChunk& chunk, std::size_t triangle, bool cull_unsnapped) const {
    std::array<VertexOutput<N>, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) corners[i] = vertex_stage(indices[3 * triangle + i]);
    to_window_triangles(
        corners, FragmentStage::kInterpolation, state.provoking_vertex, clip.x_end, clip.y_end,
        profile,
        [&](const std::array<WindowVertex, 3>& window, const std::array<Varyings<N>, 3>& varyings) {
          if (cull_unsnapped && is_culled_unsnapped(window, state.cull, state.front_face)) return;
          const auto setup = set_up_triangle(window, state.cull, state.front_face, clip, profile);
          if (!setup) return;
          LaneTriangle& t = add_set_up_triangle(chunk, *setup, provoking_index(state), profile);
          for (std::size_t i = 0; i < 3; ++i) {
            auto& row = chunk.new_vertices.emplace_back();
            const WindowVertex& v = window[i];
            row[kVertexX] = v.x;
            row[kVertexY] = v.y;
            row[kVertexDepth] = v.depth;
            row[kVertexInverseW] = v.inverse_w;
            std::copy(varyings[i].begin(), varyings[i].end(), row.begin() + kVertexVaryings);
            t.vertices[i] = row.data();
          }
        });
  }

  void assemble(LaneChunk& chunk, std::uint32_t number) const {
    const std::size_t triangle_count = indices.size() / 3;
    const std::size_t chunk_begin = std::size_t{number} * kChunkTriangles;
    const std::size_t chunk_end = std::min(chunk_begin + kChunkTriangles, triangle_count);
    for (std::size_t begin = chunk_begin; begin < chunk_end; begin += kBatchTriangles) {
      AssembleJob job{
          store,      indices,          begin,      std::min(begin + kBatchTriangles, chunk_end),
          state.cull, state.front_face, false,      fragments.provoking,
          clip,       &profile,         add_slowly, this};
      if (state.cull != Cull::none && profile.clipping == Clipping::mesa && any_outside(job)) {
        job.cull_unsnapped = true;
        job.add_slowly = add_slowly_unsnapped;
      }
      assemble_lanes(isa, job, chunk);
    }
    bin_triangles(chunk, (clip.x_end + kTileSize - 1) / kTileSize);
  }

  VertexJob vertex_job(std::uint32_t begin, std::uint32_t end) const {
    return {store, begin, end, clip.x_end, clip.y_end, &profile};
  }
};

template <class Draw>
const Draw& as(const void* draw) {
  return *static_cast<const Draw*>(draw);
}

template <class Draw>
inline constexpr LaneSteps kLaneSteps{
    [](void* draw, const VertexStore& store) { static_cast<Draw*>(draw)->store = store; },
    [](const void* draw, std::uint32_t begin, std::uint32_t end) {
      const Draw& d = as<Draw>(draw);
      return d.stages.place_vertices(d.vertex_stage, d.vertex_job(begin, end));
    },
    [](const void* draw, std::uint32_t number, LaneChunk& chunk) {
      as<Draw>(draw).assemble(chunk, number);
    },
    [](const void* draw, std::uint32_t begin, std::uint32_t end) {
      const Draw& d = as<Draw>(draw);
      d.stages.shade_vertices(d.vertex_stage, d.vertex_job(begin, end));
    },
    [](const void* draw, const VisibilityTile& tile, const VisibleRun& run) {
      const Draw& d = as<Draw>(draw);
      d.stages.shade_fragments(d.fragment_stage, d.fragments, tile, run);
    }};

}  // namespace draw_detail

/// As draw(), through kernels of the pass's isa. Needs can_draw_in_lanes().
template <class VertexStage, class FragmentStage>
void draw_lanes(RenderPass& pass, const DrawState& state, std::span<const std::uint32_t> indices,
                std::uint32_t vertex_count, VertexStage vertex_stage, FragmentStage fragment_stage,
                const LaneStages<VertexStage, FragmentStage>& stages) {
  assert(can_draw_in_lanes(pass, state));
  assert(indices.size() % 3 == 0);
  using Draw = draw_detail::LaneDraw<VertexStage, FragmentStage>;
  const auto recorded = std::make_shared<Draw>(Draw{state,
                                                    pass.profile,
                                                    pass.isa,
                                                    target_area(pass.targets),
                                                    indices,
                                                    vertex_count,
                                                    std::move(vertex_stage),
                                                    std::move(fragment_stage),
                                                    stages,
                                                    {provoking_index(state), nullptr},
                                                    {}});
  recorded->fragments.profile = &recorded->profile;

  const auto triangles = static_cast<std::uint32_t>(indices.size() / 3);
  DrawCall call;
  call.vertex_count = vertex_count;
  call.chunk_count = (triangles + kChunkTriangles - 1) / kChunkTriangles;
  call.lane_steps = &draw_detail::kLaneSteps<Draw>;
  call.lane_draw = recorded;
  call.vertex_stride = vertex_stride(Draw::N);
  call.depth = *state.depth;
  pass.draws.push_back(std::move(call));
}

}  // namespace softfocus

#pragma once
// Recording a draw in lanes: the triangles and pixels of draw(), in another order of work.
// Vertices first, many at once; then the set-up of many triangles; then a tile's depths; last
// the fragment stage, once a pixel.

#include <array>
#include <cassert>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

#include "raster/pipeline/assemble.h"
#include "raster/pipeline/lanes/assemble_lanes.h"
#include "raster/pipeline/lanes/visibility_tile.h"
#include "raster/pipeline/render_pass.h"

namespace softfocus {

/// Vertices begin <= i < end of a draw. `begin` is a multiple of kMostLanes, and the store has
/// room up to the next multiple past `end`.
struct VertexJob {
  VertexStore store;
  std::uint32_t begin;
  std::uint32_t end;
  int width;  ///< of the target
  int height;
  int samples;  ///< of a pixel
  const Profile* profile;
};

/// What the fragment stage is run with.
struct FragmentJob {
  std::size_t provoking;
  const Profile* profile;
  int samples;        ///< of a pixel
  std::size_t layer;  ///< of the tile, or kFurther
};

/// The stages of a draw, compiled for a vector unit (vertex_lanes.inl, shade_lanes.inl).
/// Fragments are discarded before the depth test, and those that are left are shaded later.
template <class VertexStage, class FragmentStage>
struct LaneStages {
  unsigned (*place_vertices)(const VertexStage&, const VertexJob&);
  void (*shade_vertices)(const VertexStage&, const VertexJob&);
  void (*shade_fragments)(const FragmentStage&, const FragmentJob&, const VisibilityTile&,
                          const VisibleRun&);
  /// Of a stage that discards fragments; see LaneSteps.
  unsigned (*keep_fragments)(const FragmentStage&, const FragmentJob&, const LaneTriangle&, int x,
                             int y, unsigned pixels) = nullptr;
};

/// Whether the kernels can carry out a draw. They leave out draws that need fragments in order
/// (blending, stencil), rare ones (scissor, masks, several targets, coverage by alpha), and
/// softpipe's.
bool can_draw_in_lanes(const RenderPass& pass, const DrawState& state);

namespace draw_detail {

// What is recorded of a draw in lanes, whatever its stages are.
struct LaneDraw {
  DrawState state;
  Profile profile;
  Isa isa;
  Rectangle target;
  int samples;
  int edge_samples;  ///< besides a pixel's centre; 1: none
  std::span<const std::uint32_t> indices;
  VertexStore store;
};

using AddSlowly = void (*)(const AssembleJob& job, LaneChunk& chunk, std::size_t triangle);

void assemble_chunk(const LaneDraw& draw, std::uint32_t number, LaneChunk& chunk,
                    AddSlowly add_slowly, const void* context);

// Sets up one triangle by the scalar functions and appends it. Triangle `number` of the draw has
// the draw's own vertices unless it is clipped.
void add_triangle(const LaneDraw& draw, LaneChunk& chunk, std::size_t number,
                  const std::array<WindowVertex, 3>& window,
                  const std::array<std::span<const float>, 3>& varyings, bool cull_unsnapped);

void record(RenderPass& pass, std::shared_ptr<void> recorded, const LaneSteps& steps,
            const LaneDraw& draw, std::uint32_t vertex_count, std::size_t varyings);

template <class VertexStage, class FragmentStage>
struct RecordedInLanes {
  static constexpr auto kInterpolation = FragmentStage::kInterpolation;
  static constexpr std::size_t N = kInterpolation.size();

  LaneDraw draw;
  VertexStage vertex_stage;
  FragmentStage fragment_stage;
  LaneStages<VertexStage, FragmentStage> stages;

  static void add_slowly(const AssembleJob& job, LaneChunk& chunk, std::size_t triangle) {
    const auto& recorded = *static_cast<const RecordedInLanes*>(job.context);
    const LaneDraw& draw = recorded.draw;
    const std::size_t count = varying_count(recorded.fragment_stage);
    std::array<VertexOutput<N>, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) {
      corners[i] = recorded.vertex_stage(draw.indices[3 * triangle + i]);
    }
    to_window_triangles(
        corners, kInterpolation, draw.state.provoking_vertex, draw.target, draw.profile,
        [&](const std::array<WindowVertex, 3>& window, const std::array<Varyings<N>, 3>& varyings) {
          const auto used = [&](std::size_t i) { return std::span{varyings[i]}.first(count); };
          add_triangle(draw, chunk, triangle, window, {used(0), used(1), used(2)},
                       job.cull_unsnapped);
        });
  }

  FragmentJob fragment_job(std::size_t layer) const {
    return {provoking_index(draw.state), &draw.profile, draw.samples, layer};
  }

  VertexJob vertex_job(std::uint32_t begin, std::uint32_t end) const {
    return {draw.store,        begin,        end,          draw.target.x_end,
            draw.target.y_end, draw.samples, &draw.profile};
  }
};

template <class Recorded>
unsigned keep(const void* recorded, const LaneTriangle& triangle, int x, int y, unsigned pixels) {
  const auto& r = *static_cast<const Recorded*>(recorded);
  return r.stages.keep_fragments(r.fragment_stage, r.fragment_job(0), triangle, x, y, pixels);
}

template <class Recorded, bool kDiscards>
inline constexpr LaneSteps kLaneSteps{
    [](void* recorded, const VertexStore& store) {
      static_cast<Recorded*>(recorded)->draw.store = store;
    },
    [](const void* recorded, std::uint32_t begin, std::uint32_t end) {
      const auto& r = *static_cast<const Recorded*>(recorded);
      return r.stages.place_vertices(r.vertex_stage, r.vertex_job(begin, end));
    },
    [](const void* recorded, std::uint32_t number, LaneChunk& chunk) {
      const auto& r = *static_cast<const Recorded*>(recorded);
      assemble_chunk(r.draw, number, chunk, Recorded::add_slowly, recorded);
    },
    [](const void* recorded, std::uint32_t begin, std::uint32_t end) {
      const auto& r = *static_cast<const Recorded*>(recorded);
      r.stages.shade_vertices(r.vertex_stage, r.vertex_job(begin, end));
    },
    [](const void* recorded, const VisibilityTile& tile, std::size_t layer, const VisibleRun& run) {
      const auto& r = *static_cast<const Recorded*>(recorded);
      r.stages.shade_fragments(r.fragment_stage, r.fragment_job(layer), tile, run);
    },
    kDiscards ? keep<Recorded> : nullptr};

}  // namespace draw_detail

/// As draw(), by kernels of the pass's isa. Needs can_draw_in_lanes().
template <class VertexStage, class FragmentStage>
void draw_in_lanes(RenderPass& pass, const DrawState& state, std::span<const std::uint32_t> indices,
                   std::uint32_t vertex_count, VertexStage vertex_stage,
                   FragmentStage fragment_stage,
                   const LaneStages<VertexStage, FragmentStage>& stages) {
  assert(can_draw_in_lanes(pass, state));
  assert(!pass.edges || pass.targets.samples == 1);
  static_assert(!is_centroid<FragmentStage>(), "lanes have a pixel's varyings at its centre");
  assert(indices.size() % 3 == 0);
  assert(!has_layers(pass.targets) || can_peel(pass.targets, state));
  const bool keeps = stages.keep_fragments != nullptr;
  assert(discards(fragment_stage) == keeps);
  using Recorded = draw_detail::RecordedInLanes<VertexStage, FragmentStage>;
  const draw_detail::LaneDraw draw{state,
                                   pass.profile,
                                   pass.isa,
                                   target_area(pass.targets),
                                   pass.targets.samples,
                                   pass.edges ? pass.edges->samples : 1,
                                   indices,
                                   {}};
  const std::size_t varyings = varying_count(fragment_stage);
  draw_detail::record(
      pass,
      std::make_shared<Recorded>(
          Recorded{draw, std::move(vertex_stage), std::move(fragment_stage), stages}),
      keeps ? draw_detail::kLaneSteps<Recorded, true> : draw_detail::kLaneSteps<Recorded, false>,
      draw, vertex_count, varyings);
}

}  // namespace softfocus

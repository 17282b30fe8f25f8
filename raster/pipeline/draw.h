#pragma once
// A scalar draw: vertex stage, clipping, set-up, sorting into tiles, fragment stage, merge.

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

#include "raster/pipeline/assemble.h"
#include "raster/pipeline/clip.h"
#include "raster/pipeline/interpolate.h"
#include "raster/pipeline/multisample.h"
#include "raster/pipeline/render_pass.h"
#include "raster/pipeline/setup.h"
#include "raster/pipeline/stages.h"

namespace softfocus {
namespace draw_detail {

template <std::size_t N>
struct Chunk {
  std::vector<Triangle<N>> triangles;
  std::vector<Bin> bins;
};

// Iterations over different vertices, chunks or tiles touch different parts of it.
template <class VertexStage, class FragmentStage, std::size_t N>
struct Recorded {
  RenderTargets targets;
  Profile profile;
  DrawState state;
  Rectangle clip;  // target and scissor
  int width;
  int height;
  std::span<const std::uint32_t> indices;
  VertexStage vertex_stage;
  FragmentStage fragment_stage;
  std::vector<VertexOutput<N>> vertices;
  std::vector<Chunk<N>> chunks;
};

template <std::size_t N>
void bin_triangle(Chunk<N>& chunk, const Triangle<N>& triangle, int tiles_x) {
  const auto index = static_cast<std::uint32_t>(chunk.triangles.size());
  const Rectangle& bounds = triangle.setup.bounds;
  for (int ty = bounds.y_begin / kTileSize; ty <= (bounds.y_end - 1) / kTileSize; ++ty) {
    for (int tx = bounds.x_begin / kTileSize; tx <= (bounds.x_end - 1) / kTileSize; ++tx) {
      chunk.bins.push_back({static_cast<std::uint32_t>(ty * tiles_x + tx), index});
    }
  }
  chunk.triangles.push_back(triangle);
}

template <class Draw, std::size_t N>
void add_triangle(const Draw& draw, Chunk<N>& chunk, const std::array<WindowVertex, 3>& window,
                  const std::array<Varyings<N>, 3>& varyings, bool cull_unsnapped) {
  const DrawState& state = draw.state;
  if (cull_unsnapped && is_culled_unsnapped(window, state.cull, state.front_face)) return;
  const auto setup = set_up_triangle(window, state.cull, state.front_face, draw.clip, draw.profile,
                                     draw.targets.samples);
  if (!setup) return;
  bin_triangle(chunk, Triangle<N>{*setup, varyings, provoking_index(state)},
               (draw.width + kTileSize - 1) / kTileSize);
}

// Whether the triangles begin <= t < end are culled by unsnapped positions too. Mesa sends a
// whole batch through its clipping stages if any vertex is outside. position(i) is a vertex's.
template <class Draw, class Position>
bool culls_unsnapped(const Draw& draw, std::size_t begin, std::size_t end,
                     const Position& position) {
  if (draw.state.cull == Cull::none || draw.profile.clipping != Clipping::mesa) return false;
  const auto indices = draw.indices.subspan(3 * begin, 3 * (end - begin));
  return std::any_of(indices.begin(), indices.end(), [&](std::uint32_t i) {
    return clip_code(position(i), draw.profile.guard_band) != 0;
  });
}

template <class Draw, std::size_t N>
void assemble_batch(const Draw& draw, Chunk<N>& chunk, std::size_t begin, std::size_t end) {
  const bool cull_unsnapped =
      culls_unsnapped(draw, begin, end, [&](std::uint32_t i) { return draw.vertices[i].position; });
  for (std::size_t t = begin; t < end; ++t) {
    std::array<VertexOutput<N>, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) corners[i] = draw.vertices[draw.indices[3 * t + i]];
    to_window_triangles(
        corners, decltype(draw.fragment_stage)::kInterpolation, draw.state.provoking_vertex,
        {0, 0, draw.width, draw.height}, draw.profile,
        [&](const std::array<WindowVertex, 3>& window, const std::array<Varyings<N>, 3>& varyings) {
          add_triangle(draw, chunk, window, varyings, cull_unsnapped);
        });
  }
}

inline void sort_bins(std::vector<Bin>& bins) {
  std::sort(bins.begin(), bins.end(), [](const Bin& a, const Bin& b) {
    return a.tile != b.tile ? a.tile < b.tile : a.triangle < b.triangle;
  });
}

template <class Draw, std::size_t N>
void assemble_chunk(const Draw& draw, Chunk<N>& chunk, std::uint32_t number) {
  const std::size_t triangle_count = draw.indices.size() / 3;
  const std::size_t chunk_begin = std::size_t{number} * kChunkTriangles;
  const std::size_t chunk_end = std::min(chunk_begin + kChunkTriangles, triangle_count);
  for (std::size_t begin = chunk_begin; begin < chunk_end; begin += kBatchTriangles) {
    assemble_batch(draw, chunk, begin, std::min(begin + kBatchTriangles, chunk_end));
  }
  sort_bins(chunk.bins);
}

// Clamped to 0..1. NaN, which planes give if a sliver's area rounds to 0, becomes 1. softpipe
// keeps the depths that a plane has beyond a sliver's vertices.
inline float clamped_depth(float depth, const Profile& profile) {
  if (profile.attributes == AttributeSetup::planes_by_quad) return depth;
  return depth <= 1.0f ? std::max(depth, 0.0f) : 1.0f;
}

template <class Draw>
bool passes_tests(const Draw& draw, int x, int y, float depth, bool front_facing) {
  return has_layers(draw.targets)
             ? reaches_layers(draw.targets, x, y, depth)
             : depth_stencil_test(draw.state, draw.targets, x, y, depth, front_facing);
}

// Samples of a pixel, a bit each, from the lowest on.
using Samples = unsigned;

constexpr bool has_sample(Samples samples, int s) { return (samples >> s & 1u) != 0; }

// What a triangle covers of a row of pixels: a span for each of their samples.
struct SampleSpans {
  std::array<Span, kMaxSamples> of_samples;
  std::size_t count = 0;
  Span all{};  // none if it is empty

  SampleSpans() = default;
  SampleSpans(const TriangleSetup& setup, int samples, int y, const Rectangle& area)
      : all{area.x_end, area.x_begin} {
    for (const glm::ivec2& place : sample_places(samples)) {
      const Span span = covered_span(setup, y, area.x_begin, area.x_end, place);
      of_samples[count++] = span;
      if (span.x_begin >= span.x_end) continue;
      all = {std::min(all.x_begin, span.x_begin), std::max(all.x_end, span.x_end)};
    }
  }

  Samples covered(int x) const {
    Samples samples = 0;
    for (std::size_t s = 0; s < count; ++s) {
      if (of_samples[s].x_begin <= x && x < of_samples[s].x_end) samples |= 1u << s;
    }
    return samples;
  }
};

// Those that alpha leaves of a pixel's `count`.
inline Samples alpha_coverage(float alpha, int count) {
  Samples kept = 0;
  for (int s = 0; s < count; ++s) {
    const float least = static_cast<float>(s) / static_cast<float>(count);
    if (!(alpha <= least)) kept |= 1u << s;
  }
  return kept;
}

// `covered`: the samples of pixel (x, y) that the triangle covers.
template <class Interpolator, class Draw, std::size_t N>
void shade_fragment(const Draw& draw, const Triangle<N>& triangle, const Interpolator& interpolator,
                    int x, int y, Samples covered) {
  using FragmentStage = decltype(draw.fragment_stage);
  const int count = draw.targets.samples;
  const std::span<const glm::ivec2> places = sample_places(count);
  const bool front = triangle.setup.front_facing;
  Interpolated<N> values = interpolator.at(x, y);
  const float depth = clamped_depth(values.depth, draw.profile);
  // Those of some samples that pass.
  const auto tested = [&](Samples samples) {
    Samples passing = 0;
    for (int s = 0; s < count; ++s) {
      if (!has_sample(samples, s)) continue;
      const float own = count == 1 ? depth
                                   : clamped_depth(interpolator.depth(interpolator.pixel(
                                                       x, y, places[static_cast<std::size_t>(s)])),
                                                   draw.profile);
      if (passes_tests(draw, x, y * count + s, own, front)) passing |= 1u << s;
    }
    return passing;
  };
  // If the stage leaves out no fragment, the tests come before it.
  const bool covers_by_alpha = count > 1 && draw.state.alpha_to_coverage;
  const bool tests_come_last =
      (FragmentStage::kDiscards && discards(draw.fragment_stage)) || covers_by_alpha;
  if (!tests_come_last) covered = tested(covered);
  if (covered == 0) return;
  if (is_centroid<FragmentStage>() && covered != (1u << count) - 1) {
    const auto first = static_cast<std::size_t>(std::countr_zero(covered));
    values.varyings = interpolator.at(x, y, places[first]).varyings;
  }
  Fragment<N> fragment{.x = x,
                       .y = y,
                       .depth = depth,
                       .front_facing = front,
                       .varyings = values.varyings,
                       .ddx = {},
                       .ddy = {}};
  if constexpr (FragmentStage::kNeedsDerivatives) {
    const int x0 = x & ~1;
    const int y0 = y & ~1;
    // softpipe takes the difference along x from the block's lower row.
    const int y_of_ddx = draw.profile.attributes == AttributeSetup::planes_by_quad ? y0 + 1 : y0;
    const Varyings<N> corner = interpolator.at(x0, y0).varyings;
    const Varyings<N> left = interpolator.at(x0, y_of_ddx).varyings;
    const Varyings<N> right = interpolator.at(x0 + 1, y_of_ddx).varyings;
    const Varyings<N> below = interpolator.at(x0, y0 + 1).varyings;
    for (std::size_t i = 0; i < N; ++i) {
      fragment.ddx[i] = right[i] - left[i];
      fragment.ddy[i] = below[i] - corner[i];
    }
  }
  const auto output = draw.fragment_stage(fragment);
  if (tests_come_last) {
    if (output.discard) return;
    if (covers_by_alpha) covered &= alpha_coverage(output.colour[0].w, count);
    covered = tested(covered);
  }
  if (has_layers(draw.targets)) {
    if (covered != 0) {
      insert_into_layers(draw.targets, x, y, depth, output.colour[0], draw.profile);
    }
    return;
  }
  for (std::size_t i = 0; i < output.colour.size(); ++i) {
    if (draw.targets.colour[i] == nullptr) continue;
    for (int s = 0; s < count; ++s) {
      if (has_sample(covered, s)) {
        write_colour(draw.state.colour[i], *draw.targets.colour[i], x, y * count + s,
                     output.colour[i], draw.profile);
      }
    }
  }
}

template <class Interpolator, class Draw, std::size_t N>
void shade_triangle(const Draw& draw, const Triangle<N>& triangle, const Rectangle& tile) {
  const TriangleSetup& setup = triangle.setup;
  const Rectangle area = intersection(tile, setup.bounds);
  const Interpolator interpolator{triangle, draw.profile,
                                  decltype(draw.fragment_stage)::kInterpolation};
  for (int y = area.y_begin; y < area.y_end; ++y) {
    const SampleSpans spans{setup, draw.targets.samples, y, area};
    for (int x = spans.all.x_begin; x < spans.all.x_end; ++x) {
      const Samples covered = spans.covered(x);
      if (covered != 0) shade_fragment(draw, triangle, interpolator, x, y, covered);
    }
  }
}

template <class Draw, std::size_t N>
void shade_tile(const Draw& draw, const Chunk<N>& chunk, std::span<const Bin> bins,
                const Rectangle& tile) {
  for (const Bin& bin : bins) {
    const Triangle<N>& triangle = chunk.triangles[bin.triangle];
    switch (draw.profile.attributes) {
      case AttributeSetup::exact_barycentric:
        shade_triangle<BarycentricInterpolator<N>>(draw, triangle, tile);
        break;
      case AttributeSetup::planes_from_origin:
        shade_triangle<PlaneInterpolator<PlanesFromOrigin, N>>(draw, triangle, tile);
        break;
      case AttributeSetup::planes_by_quad:
        shade_triangle<PlaneInterpolator<PlanesByQuad, N>>(draw, triangle, tile);
        break;
    }
  }
}

template <class Recorded>
inline constexpr ScalarSteps kScalarSteps{
    [](void* recorded, std::uint32_t begin, std::uint32_t end) {
      auto& draw = *static_cast<Recorded*>(recorded);
      for (std::uint32_t i = begin; i < end; ++i) draw.vertices[i] = draw.vertex_stage(i);
    },
    [](void* recorded, std::uint32_t chunk) {
      auto& draw = *static_cast<Recorded*>(recorded);
      assemble_chunk(draw, draw.chunks[chunk], chunk);
    },
    [](const void* recorded, std::uint32_t chunk) {
      return std::span<const Bin>{static_cast<const Recorded*>(recorded)->chunks[chunk].bins};
    },
    [](const void* recorded, std::uint32_t chunk, std::span<const Bin> bins,
       const Rectangle& tile) {
      const auto& draw = *static_cast<const Recorded*>(recorded);
      shade_tile(draw, draw.chunks[chunk], bins, tile);
    }};

}  // namespace draw_detail

/// Records a draw of indices.size() / 3 triangles. The stages are copied; data that they and
/// `indices` point to must live until finish(). Needs every index below `vertex_count` and
/// indices.size() a multiple of 3. A profile with barycentric attributes needs edge functions,
/// which give the weights.
template <class VertexStage, class FragmentStage>
void draw(RenderPass& pass, const DrawState& state, std::span<const std::uint32_t> indices,
          std::uint32_t vertex_count, VertexStage vertex_stage, FragmentStage fragment_stage) {
  constexpr std::size_t N = FragmentStage::kInterpolation.size();
  static_assert(N <= kMaxVaryings);
  static_assert(std::tuple_size_v<decltype(fragment_stage(Fragment<N>{}).colour)> <=
                kMaxColourTargets);
  assert(indices.size() % 3 == 0);
  assert(pass.profile.coverage == Coverage::edge_functions ||
         pass.profile.attributes != AttributeSetup::exact_barycentric);
  assert(!has_layers(pass.targets) || can_peel(pass.targets, state));
  assert(pass.targets.samples == 1 ||
         (pass.profile.coverage == Coverage::edge_functions && !has_layers(pass.targets)));
  using Recorded = draw_detail::Recorded<VertexStage, FragmentStage, N>;

  const Rectangle target = target_area(pass.targets);
  const Rectangle clip = state.scissor ? intersection(target, *state.scissor) : target;
  const auto triangles = static_cast<std::uint32_t>(indices.size() / 3);
  const std::uint32_t chunks = (triangles + kChunkTriangles - 1) / kChunkTriangles;
  auto recorded = std::make_shared<Recorded>(Recorded{
      pass.targets, pass.profile, state, clip, target.x_end, target.y_end, indices,
      std::move(vertex_stage), std::move(fragment_stage),
      std::vector<VertexOutput<N>>(vertex_count), std::vector<draw_detail::Chunk<N>>(chunks)});

  DrawCall call;
  call.vertex_count = vertex_count;
  call.chunk_count = chunks;
  call.recorded = std::move(recorded);
  call.scalar_steps = &draw_detail::kScalarSteps<Recorded>;
  pass.draws.push_back(std::move(call));
}

}  // namespace softfocus

#pragma once
// The draw call: vertex stage, clipping, set-up, binning, fragment stage, merge.

#include <algorithm>
#include <cassert>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

#include "raster/pipeline/clip.h"
#include "raster/pipeline/interpolate.h"
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

// All that a recorded draw holds. Loops over different vertices, chunks or tiles touch
// different parts of it.
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
void add_triangle(const Draw& draw, Chunk<N>& chunk,
                  const std::array<VertexOutput<N>, 3>& corners) {
  std::array<WindowVertex, 3> window{};
  Triangle<N> triangle{};
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(corners[i].position.w > 0.0f)) return;  // only a degenerate matrix leaves it so
    window[i] = to_window(corners[i].position, draw.width, draw.height, draw.profile);
    triangle.varyings[i] = corners[i].varyings;
  }
  const auto setup = set_up_triangle(window, draw.state.cull, draw.state.front_face, draw.clip);
  if (!setup) return;
  triangle.setup = *setup;
  bin_triangle(chunk, triangle, (draw.width + kTileSize - 1) / kTileSize);
}

template <class Draw, std::size_t N>
void add_clipped(const Draw& draw, Chunk<N>& chunk, const std::array<VertexOutput<N>, 3>& corners,
                 unsigned planes, const std::array<Interpolation, N>& kinds) {
  ClipPolygon polygon;
  polygon.count = 3;
  for (std::size_t i = 0; i < 3; ++i) {
    polygon.vertices[i].position = corners[i].position;
    for (std::size_t k = 0; k < N; ++k) {
      // The fan below has other first vertices than the triangle: flat values go along.
      const std::size_t source = kinds[k] == Interpolation::flat ? 0 : i;
      polygon.vertices[i].varyings[k] = corners[source].varyings[k];
    }
  }
  clip_polygon(polygon, planes, draw.profile.guard_band, kinds);
  const auto corner = [&](std::size_t i) {
    VertexOutput<N> output{polygon.vertices[i].position, {}};
    std::copy_n(polygon.vertices[i].varyings.begin(), N, output.varyings.begin());
    return output;
  };
  for (std::size_t i = 2; i < polygon.count; ++i) {
    add_triangle(draw, chunk, std::array{corner(0), corner(i - 1), corner(i)});
  }
}

template <class Draw, std::size_t N>
void assemble_chunk(const Draw& draw, Chunk<N>& chunk, std::uint32_t number,
                    const std::array<Interpolation, N>& kinds) {
  const std::size_t triangle_count = draw.indices.size() / 3;
  const std::size_t begin = std::size_t{number} * kChunkTriangles;
  const std::size_t end = std::min(begin + kChunkTriangles, triangle_count);
  for (std::size_t t = begin; t < end; ++t) {
    std::array<VertexOutput<N>, 3> corners;
    unsigned outside_any = 0;
    unsigned outside_all = ~0u;
    for (std::size_t i = 0; i < 3; ++i) {
      corners[i] = draw.vertices[draw.indices[3 * t + i]];
      const unsigned code = clip_code(corners[i].position, draw.profile.guard_band);
      outside_any |= code;
      outside_all &= code;
    }
    if (outside_all != 0 || (outside_any & kNotFinite) != 0) continue;
    if (outside_any == 0) {
      add_triangle(draw, chunk, corners);
    } else {
      add_clipped(draw, chunk, corners, outside_any, kinds);
    }
  }
  std::sort(chunk.bins.begin(), chunk.bins.end(), [](const Bin& a, const Bin& b) {
    return a.tile != b.tile ? a.tile < b.tile : a.triangle < b.triangle;
  });
}

template <class Interpolator, class Draw, std::size_t N>
void shade_fragment(const Draw& draw, const Triangle<N>& triangle, const Interpolator& interpolator,
                    int x, int y) {
  using FragmentStage = decltype(draw.fragment_stage);
  constexpr auto& kinds = FragmentStage::kInterpolation;
  const Interpolated<N> values = interpolator.at(x, y, kinds);
  const float depth = std::clamp(values.depth, 0.0f, 1.0f);
  const bool front = triangle.setup.front_facing;
  // Tests come first where the stage cannot take a fragment back.
  if (!FragmentStage::kDiscards &&
      !depth_stencil_test(draw.state, draw.targets, x, y, depth, front)) {
    return;
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
    const Varyings<N> corner = interpolator.at(x0, y0, kinds).varyings;
    const Varyings<N> right = interpolator.at(x0 + 1, y0, kinds).varyings;
    const Varyings<N> below = interpolator.at(x0, y0 + 1, kinds).varyings;
    for (std::size_t i = 0; i < N; ++i) {
      fragment.ddx[i] = right[i] - corner[i];
      fragment.ddy[i] = below[i] - corner[i];
    }
  }
  const auto output = draw.fragment_stage(fragment);
  if (FragmentStage::kDiscards &&
      (output.discard || !depth_stencil_test(draw.state, draw.targets, x, y, depth, front))) {
    return;
  }
  for (std::size_t i = 0; i < output.colour.size(); ++i) {
    if (draw.targets.colour[i] != nullptr) {
      write_colour(draw.state.colour[i], *draw.targets.colour[i], x, y, output.colour[i],
                   draw.profile);
    }
  }
}

template <class Interpolator, class Draw, std::size_t N>
void shade_triangle(const Draw& draw, const Triangle<N>& triangle, const Rectangle& tile) {
  const TriangleSetup& setup = triangle.setup;
  const Rectangle area{
      std::max(tile.x_begin, setup.bounds.x_begin), std::max(tile.y_begin, setup.bounds.y_begin),
      std::min(tile.x_end, setup.bounds.x_end), std::min(tile.y_end, setup.bounds.y_end)};
  const Interpolator interpolator{triangle, draw.profile};
  const auto& edges = setup.edges;
  for (int y = area.y_begin; y < area.y_end; ++y) {
    std::int64_t e0 = edge_at(edges[0], area.x_begin, y);
    std::int64_t e1 = edge_at(edges[1], area.x_begin, y);
    std::int64_t e2 = edge_at(edges[2], area.x_begin, y);
    for (int x = area.x_begin; x < area.x_end; ++x) {
      if (inside(edges[0], e0) && inside(edges[1], e1) && inside(edges[2], e2)) {
        shade_fragment(draw, triangle, interpolator, x, y);
      }
      e0 += edges[0].per_x;
      e1 += edges[1].per_x;
      e2 += edges[2].per_x;
    }
  }
}

template <class Draw, std::size_t N>
void shade_tile(const Draw& draw, const Chunk<N>& chunk, std::span<const Bin> bins,
                const Rectangle& tile) {
  for (const Bin& bin : bins) {
    const Triangle<N>& triangle = chunk.triangles[bin.triangle];
    if (draw.profile.attributes == AttributeSetup::exact_barycentric) {
      shade_triangle<BarycentricInterpolator<N>>(draw, triangle, tile);
    } else {
      shade_triangle<PlaneInterpolator<N>>(draw, triangle, tile);
    }
  }
}

}  // namespace draw_detail

/// Records a draw of indices.size() / 3 triangles: the stages are copied, what they
/// and `indices` point to must live until finish(). Needs every index below
/// `vertex_count`, and indices.size() a multiple of 3.
template <class VertexStage, class FragmentStage>
void draw(RenderPass& pass, const DrawState& state, std::span<const std::uint32_t> indices,
          std::uint32_t vertex_count, VertexStage vertex_stage, FragmentStage fragment_stage) {
  constexpr std::size_t N = FragmentStage::kInterpolation.size();
  static_assert(N <= kMaxVaryings);
  static_assert(std::tuple_size_v<decltype(fragment_stage(Fragment<N>{}).colour)> <=
                kMaxColourTargets);
  assert(indices.size() % 3 == 0);
  using Recorded = draw_detail::Recorded<VertexStage, FragmentStage, N>;

  const Rectangle target = target_area(pass.targets);
  Rectangle clip = target;
  if (state.scissor) {
    clip = {std::max(clip.x_begin, state.scissor->x_begin),
            std::max(clip.y_begin, state.scissor->y_begin),
            std::min(clip.x_end, state.scissor->x_end), std::min(clip.y_end, state.scissor->y_end)};
  }
  const auto triangles = static_cast<std::uint32_t>(indices.size() / 3);
  const std::uint32_t chunks = (triangles + kChunkTriangles - 1) / kChunkTriangles;
  auto recorded = std::make_shared<Recorded>(Recorded{
      pass.targets, pass.profile, state, clip, target.x_end, target.y_end, indices,
      std::move(vertex_stage), std::move(fragment_stage),
      std::vector<VertexOutput<N>>(vertex_count), std::vector<draw_detail::Chunk<N>>(chunks)});

  DrawCall call;
  call.vertex_count = vertex_count;
  call.chunk_count = chunks;
  call.shade_vertices = [recorded](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t i = begin; i < end; ++i) recorded->vertices[i] = recorded->vertex_stage(i);
  };
  call.assemble = [recorded](std::uint32_t chunk) {
    draw_detail::assemble_chunk(*recorded, recorded->chunks[chunk], chunk,
                                FragmentStage::kInterpolation);
  };
  call.bins = [recorded](std::uint32_t chunk) -> std::span<const Bin> {
    return recorded->chunks[chunk].bins;
  };
  call.shade_tile = [recorded](std::uint32_t chunk, std::span<const Bin> bins,
                               const Rectangle& tile) {
    draw_detail::shade_tile(*recorded, recorded->chunks[chunk], bins, tile);
  };
  pass.draws.push_back(std::move(call));
}

}  // namespace softfocus

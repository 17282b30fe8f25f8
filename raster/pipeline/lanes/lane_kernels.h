#pragma once
// The vector kernels of set-up and coverage: the same for every draw.

#include <cstdint>
#include <glm/vec4.hpp>
#include <span>

#include "raster/lanes/isa.h"
#include "raster/pipeline/lanes/lane_draw.h"

namespace softfocus {

/// Triangles of a draw that are assembled together.
struct AssembleJob {
  VertexStore vertices;
  std::span<const std::uint32_t> indices;
  std::size_t begin;  ///< triangles
  std::size_t end;
  Cull cull;
  FrontFace front_face;
  bool cull_unsnapped;
  std::size_t provoking;  ///< the vertex that gives flat varyings their value: 0 or 2
  Rectangle clip;
  const Profile* profile;
  /// For a triangle that has to be clipped or is large.
  void (*add_slowly)(const void* context, LaneChunk& chunk, std::size_t triangle);
  const void* context;
};

/// Whether a vertex of the triangles is outside of a clip plane.
bool any_outside(const AssembleJob& job);

/// Sets up the triangles that are to be drawn and appends them to the chunk in order. Needs
/// an isa other than scalar, here and below.
void assemble_lanes(Isa isa, const AssembleJob& job, LaneChunk& chunk);

/// Depth-tests the listed triangles of a chunk against a tile, in order, and puts their ids
/// where they are seen.
void rasterize_lanes(Isa isa, const LaneChunk& chunk, std::span<const Bin> bins,
                     const DepthState& state, const Profile& profile, VisibilityTile& tile);

/// Sets the pixels of the tile that show nothing.
void clear_unseen(Isa isa, const VisibilityTile& tile, glm::vec4 value, const Profile& profile);

}  // namespace softfocus

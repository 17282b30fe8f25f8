#pragma once
// Triangle set-up in lanes: the same kernel for every draw.

#include <cstdint>
#include <span>

#include "raster/lanes/isa.h"
#include "raster/numbers/profile.h"
#include "raster/pipeline/lanes/lane_chunk.h"
#include "raster/pipeline/state.h"

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
  int samples;       ///< of a pixel
  int edge_samples;  ///< besides its centre; 1: none
  const Profile* profile;
  /// Adds a triangle that is large or has to be clipped.
  void (*add_slowly)(const AssembleJob& job, LaneChunk& chunk, std::size_t triangle);
  const void* context;  ///< for add_slowly
};

/// Sets up the triangles that are to be drawn and appends them to the chunk in order. Needs an
/// isa with vectors.
void assemble_lanes(Isa isa, const AssembleJob& job, LaneChunk& chunk);

}  // namespace softfocus

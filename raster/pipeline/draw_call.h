#pragma once
// A recorded draw call: the stages and their data behind functions that a render pass
// calls, each for a batch of vertices, triangles or a whole tile, never for a single
// fragment.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "raster/pipeline/state.h"

namespace softfocus {

/// The triangles that Mesa's drivers send through their clipping stages together: as
/// many as 1,024 indices of 32 bits make, counted from the draw's first.
inline constexpr std::uint32_t kBatchTriangles = 341;

/// Triangles are assembled in chunks of this many, tiles are so many pixels square.
/// Neither number shows in a result. A chunk holds whole batches.
inline constexpr std::uint32_t kChunkTriangles = 3 * kBatchTriangles;
inline constexpr std::uint32_t kChunkVertices = 1024;
inline constexpr int kTileSize = 64;

/// "Triangle `triangle` of the chunk touches tile `tile`." Sorted by tile, then by
/// triangle, which is the order of submission.
struct Bin {
  std::uint32_t tile;
  std::uint32_t triangle;
};

// Of the vector kernels (lane_draw.h).
struct VertexStore;
struct LaneChunk;
struct VisibilityTile;
struct VisibleRun;

/// The steps of a draw in lanes, each on what was recorded of it.
struct LaneSteps {
  /// Where the vertices are to go; before anything else.
  void (*use_store)(void* draw, const VertexStore& store);
  /// Positions of the vertices begin <= i < end. Returns the clip codes that all have.
  unsigned (*place_vertices)(const void* draw, std::uint32_t begin, std::uint32_t end);
  /// Clips and sets up the triangles of a chunk, and sorts them into tiles.
  void (*assemble)(const void* draw, std::uint32_t number, LaneChunk& chunk);
  /// Runs the vertex stage over those of the vertices that triangles to be drawn have.
  void (*shade_vertices)(const void* draw, std::uint32_t begin, std::uint32_t end);
  /// Shades the pixels of a tile that show a run of the draw's triangles.
  void (*shade_seen)(const void* draw, const VisibilityTile& tile, const VisibleRun& run);
};

struct DrawCall {
  std::uint32_t vertex_count = 0;
  std::uint32_t chunk_count = 0;

  // --- one fragment after the other ---

  /// Runs the vertex stage over vertices begin <= i < end.
  std::function<void(std::uint32_t begin, std::uint32_t end)> shade_vertices;
  /// Clips and sets up the triangles of a chunk, and sorts them into tiles.
  std::function<void(std::uint32_t chunk)> assemble;
  std::function<std::span<const Bin>(std::uint32_t chunk)> bins;
  /// Draws the listed triangles of a chunk inside `tile`.
  std::function<void(std::uint32_t chunk, std::span<const Bin> bins, const Rectangle& tile)>
      shade_tile;

  // --- in lanes ---

  const LaneSteps* lane_steps = nullptr;  ///< none: the draw is not in lanes
  std::shared_ptr<void> lane_draw = nullptr;
  std::uint32_t vertex_stride = 0;  ///< floats that a vertex takes
  DepthState depth = {};
  // What is found on the way: where its rows begin, and whether all of it lies beyond one plane of
  // the view.
  std::size_t first_line = 0;
  bool is_outside = false;
};

}  // namespace softfocus

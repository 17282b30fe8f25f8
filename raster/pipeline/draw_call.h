#pragma once
// A recorded draw call: tables of functions that run a draw's stages, each over a batch of
// vertices, over triangles or over a tile, never over a single fragment.

#include <cstdint>
#include <memory>
#include <span>

#include "raster/pipeline/state.h"

namespace softfocus {

/// Triangles that Mesa's drivers send through their clipping stages together: whole triangles
/// of 1,024 indices of 32 bits, counted from the draw's first.
inline constexpr std::uint32_t kBatchTriangles = 341;

/// Triangles are assembled in chunks, vertices in batches; a tile is kTileSize pixels wide and
/// high. These numbers do not show in a result, as a chunk holds whole batches of triangles.
inline constexpr std::uint32_t kChunkTriangles = 3 * kBatchTriangles;
inline constexpr std::uint32_t kChunkVertices = 1024;
inline constexpr int kTileSize = 64;

/// "Triangle `triangle` of the chunk touches tile `tile`." Sorted by tile, then by triangle,
/// which is the order of submission.
struct Bin {
  std::uint32_t tile;
  std::uint32_t triangle;
};

/// The steps of a scalar draw (draw.h), on what was recorded of it. In this order.
struct ScalarSteps {
  /// Runs the vertex stage over the vertices begin <= i < end.
  void (*shade_vertices)(void* recorded, std::uint32_t begin, std::uint32_t end);
  /// Clips and sets up a chunk's triangles, and sorts them into tiles.
  void (*assemble)(void* recorded, std::uint32_t chunk);
  std::span<const Bin> (*bins)(const void* recorded, std::uint32_t chunk);
  /// Draws the listed triangles of a chunk inside `tile`.
  void (*shade_tile)(const void* recorded, std::uint32_t chunk, std::span<const Bin> bins,
                     const Rectangle& tile);
};

struct VertexStore;
struct LaneChunk;
struct LaneTriangle;
struct VisibilityTile;
struct VisibleRun;

/// The steps of a draw in lanes (draw_in_lanes.h). In this order.
struct LaneSteps {
  /// Says where vertices go.
  void (*use_store)(void* recorded, const VertexStore& store);
  /// Finds the positions of the vertices begin <= i < end. Returns the bits that all their clip
  /// codes share.
  unsigned (*place_vertices)(const void* recorded, std::uint32_t begin, std::uint32_t end);
  /// Clips and sets up a chunk's triangles, and sorts them into tiles.
  void (*assemble)(const void* recorded, std::uint32_t number, LaneChunk& chunk);
  /// Runs the vertex stage over the vertices of triangles that are drawn.
  void (*shade_vertices)(const void* recorded, std::uint32_t begin, std::uint32_t end);
  /// Shades the pixels of a tile's layer that show a run of the draw's triangles.
  void (*shade_seen)(const void* recorded, const VisibilityTile& tile, std::size_t layer,
                     const VisibleRun& run);
  /// Of some pixels of a part of a block, a bit a lane, those whose fragments are not discarded.
  /// Pixel (x, y) is the part's first. Null if the fragment stage discards nothing.
  unsigned (*keep)(const void* recorded, const LaneTriangle& triangle, int x, int y,
                   unsigned pixels);
};

struct DrawCall {
  std::uint32_t vertex_count = 0;
  std::uint32_t chunk_count = 0;
  std::shared_ptr<void> recorded = nullptr;  ///< what the steps get
  // One of the two is null.
  const ScalarSteps* scalar_steps = nullptr;
  const LaneSteps* lane_steps = nullptr;

  // --- in lanes ---

  std::uint32_t vertex_stride = 0;  ///< floats that a vertex takes
  DepthState depth = {};
  std::size_t first_line = 0;  ///< where its rows begin in the pass's memory
  bool is_outside = false;     ///< found on the way: all of it lies beyond one plane of the view
};

}  // namespace softfocus

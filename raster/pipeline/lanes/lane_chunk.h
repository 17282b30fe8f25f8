#pragma once
// Vertices and triangles of a draw in lanes: columns and rows of vertices, and chunks of
// triangles that are set up and sorted into tiles.

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "raster/numbers/profile.h"
#include "raster/pipeline/draw_call.h"
#include "raster/pipeline/setup.h"
#include "raster/pipeline/stages.h"

namespace softfocus {

/// A vertex as a row of floats: these, then its varyings, filled up to a multiple of four.
inline constexpr std::size_t kVertexX = 0, kVertexY = 1, kVertexDepth = 2, kVertexInverseW = 3,
                             kVertexVaryings = 4;

inline constexpr std::size_t vertex_row_size(std::size_t varyings) {
  return (kVertexVaryings + varyings + 3) / 4 * 4;
}

/// Rows begin on lines of a cache, so that most vertices lie in one line.
inline constexpr std::size_t kLineFloats = 16;
inline constexpr std::size_t vertex_stride(std::size_t varyings) {
  return (kVertexVaryings + varyings + kLineFloats - 1) / kLineFloats * kLineFloats;
}

/// A bit beside the clip code: set-up refuses the window position (is_drawable()).
inline constexpr unsigned kNotDrawable = 1u << 30;

/// The vertices of a draw: columns, with what set-up needs of each; rows, filled for the
/// vertices of triangles that are drawn.
struct VertexStore {
  float* rows = nullptr;  ///< `stride` floats a vertex
  std::size_t stride = 0;
  std::int32_t* snapped_x = nullptr;  ///< in 1/256 pixel from the centre of pixel (0, 0)
  std::int32_t* snapped_y = nullptr;
  std::int32_t* codes = nullptr;  ///< clip_code() and kNotDrawable
  float* x = nullptr;             ///< in the window, as are y and depth
  float* y = nullptr;
  float* depth = nullptr;
  std::uint8_t* used = nullptr;  ///< 1: the row is wanted; else 0
};

/// Chunks share vertices, and threads take chunks. clang's library has no std::atomic_ref.
inline void mark_used(const VertexStore& vertices, std::size_t vertex) {
#ifdef __wasm__
  // Its only atomic store is the strictest one; most vertices are marked already.
  if (__atomic_load_n(&vertices.used[vertex], __ATOMIC_RELAXED) != 0) return;
#endif
  __atomic_store_n(&vertices.used[vertex], std::uint8_t{1}, __ATOMIC_RELAXED);
}

/// A triangle no wider and higher than this, in 1/256 pixel, is small: 32 bits hold its edge
/// functions in all 4x4 blocks of pixels that its bounds touch. They stay below
/// 2 * 22528 * (22528 + 8 * 256) < 2^31.
inline constexpr std::int32_t kSmallExtent = 88 * 256;

/// The edge functions of a triangle that is not small.
struct LargeEdges {
  EdgeFunctions exact;
  /// In binary64, from the first pixel of the triangle's bounds. Exact up to kWideExtent.
  std::array<double, 3> edge, per_x, per_y;
  bool fits_doubles;
};

/// In 1/256 pixel. Values in the blocks that the bounds touch, and the sums that lead to them,
/// stay below 2 * 2^33 * (2^17 + 8) < 2^53.
inline constexpr std::int64_t kWideExtent = 1 << 25;

/// A pixel's x in the lower 16 bits, y in the upper.
inline constexpr std::int32_t packed_pixel(int x, int y) {
  return static_cast<std::int32_t>((static_cast<std::uint32_t>(x) & 0xFFFFu) |
                                   static_cast<std::uint32_t>(y) << 16);
}

/// A triangle that is drawn, in two lines of a cache. The first has all that says where it is seen.
struct alignas(64) LaneTriangle {
  // Twice four numbers, which kernels load at once.
  /// Edge functions of a small triangle, at `origin`.
  std::array<std::int32_t, 3> edge;
  std::int32_t origin;  ///< packed_pixel() of the bounds' first
  /// Of a small triangle: their differences from pixel to pixel, over 256, along x in the lower 16
  /// bits and along y in the upper. Those 16 bits hold kSmallExtent.
  std::array<std::int32_t, 3> slopes;
  float inverse_area;
  /// Of vertex 0, then the others less it; or a plane's at_origin, per_x, per_y.
  std::array<float, 3> depth;
  std::array<std::int16_t, 4> bounds;     ///< x_begin, y_begin, x_end, y_end
  std::array<std::int8_t, 3> thresholds;  ///< covered where each E >= its threshold: 0 or 1
  bool clockwise;
  bool front_facing;
  bool is_large;
  std::array<const float*, 3> vertices;
  const LargeEdges* large;  ///< null if it is small
};
static_assert(offsetof(LaneTriangle, edge) == 0 &&
              offsetof(LaneTriangle, slopes) == 4 * sizeof(float));

inline constexpr std::int32_t packed_slopes(std::int32_t per_x, std::int32_t per_y) {
  return static_cast<std::int32_t>((static_cast<std::uint32_t>(per_x / 256) & 0xFFFFu) |
                                   static_cast<std::uint32_t>(per_y / 256) << 16);
}
inline constexpr std::int32_t slope_x(std::int32_t packed) {
  return static_cast<std::int16_t>(packed & 0xFFFF) * 256;
}
inline constexpr std::int32_t slope_y(std::int32_t packed) { return (packed >> 16) * 256; }

/// The chunk's bins begin <= i < end are of one tile.
struct TileBins {
  std::uint32_t tile;
  std::uint32_t begin;
  std::uint32_t end;
};

struct LaneChunk {
  std::unique_ptr<LaneTriangle[]> triangles;  ///< the first triangle_count are in use
  std::uint32_t triangle_count = 0;
  std::uint32_t triangle_room = 0;
  std::vector<Bin> bins;
  std::vector<TileBins> tiles;
  // Made by clipping, and edges of large triangles. Triangles point to them, so they must not move.
  std::deque<std::array<float, vertex_row_size(kMaxVaryings)>> new_vertices;
  std::deque<LargeEdges> large;
};

/// Empties the chunk and keeps its memory.
void clear(LaneChunk& chunk);

/// Makes room for more triangles.
void enlarge(LaneChunk& chunk);

/// Appends a triangle for the caller to fill in.
inline LaneTriangle& next_triangle(LaneChunk& chunk) {
  if (chunk.triangle_count == chunk.triangle_room) enlarge(chunk);
  LaneTriangle& triangle = chunk.triangles[chunk.triangle_count++];
  // The next ones were last read in another frame.
  constexpr std::size_t kBytesAhead = 8 * sizeof(LaneTriangle);
  const char* ahead = reinterpret_cast<const char*>(&triangle) + kBytesAhead;
  __builtin_prefetch(ahead, 1);
  __builtin_prefetch(ahead + kLineFloats * sizeof(float), 1);
  return triangle;
}

/// Appends a triangle that scalar code set up. The caller gives it its vertices.
LaneTriangle& add_set_up_triangle(LaneChunk& chunk, const TriangleSetup& setup,
                                  std::size_t provoking, const Profile& profile);

/// Sorts the chunk's triangles into its bins.
void bin_triangles(LaneChunk& chunk, int tiles_x);

struct alignas(4 * kLineFloats) CacheLine {
  std::array<float, kLineFloats> floats;
};

/// The memory of a pass's draws, kept from frame to frame.
struct LaneMemory {
  std::unique_ptr<CacheLine[]> rows;  ///< mostly untouched: few vertices are used
  std::size_t row_lines = 0;
  std::vector<std::int32_t> integer_columns;
  std::vector<float> float_columns;
  std::vector<std::uint8_t> used;  ///< all 0 between frames
  std::vector<LaneChunk> chunks;
};

}  // namespace softfocus

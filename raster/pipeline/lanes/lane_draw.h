#pragma once
// What a draw leaves in memory on its way through the vector kernels: shaded vertices,
// triangles with their edge functions, and for a tile the nearest triangle of each pixel.
// Fragments are shaded once a tile's triangles are all through, so a pixel is shaded once.

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "raster/images/image.h"
#include "raster/numbers/profile.h"
#include "raster/pipeline/draw_call.h"
#include "raster/pipeline/edge_functions.h"
#include "raster/pipeline/setup.h"
#include "raster/pipeline/stages.h"
#include "raster/pipeline/state.h"

namespace softfocus {

/// A vertex as one row of floats: these, and then its varyings, up to a multiple of four.
enum VertexRow : std::size_t { kVertexX, kVertexY, kVertexDepth, kVertexInverseW, kVertexVaryings };

inline constexpr std::size_t vertex_row_size(std::size_t varyings) {
  return (kVertexVaryings + varyings + 3) / 4 * 4;
}

/// From row to row: whole lines of a cache, of which few vertices then have two.
inline constexpr std::size_t kLineFloats = 16;
inline constexpr std::size_t vertex_stride(std::size_t varyings) {
  return (kVertexVaryings + varyings + kLineFloats - 1) / kLineFloats * kLineFloats;
}

/// Beside the clip codes: a window position that set-up takes for no number.
inline constexpr unsigned kNotDrawable = 1u << 30;

/// The vertices of a draw. Columns of what set-up asks of every vertex, and rows of those that
/// the triangles to be drawn have.
struct VertexStore {
  float* rows = nullptr;  ///< `stride` floats a vertex, at lines of a cache
  std::size_t stride = 0;
  std::int32_t* snapped_x = nullptr;  ///< in 1/256 pixel from the centre of pixel (0, 0)
  std::int32_t* snapped_y = nullptr;
  std::int32_t* codes = nullptr;  ///< clip_code(), kNotDrawable
  float* x = nullptr;             ///< in the window, and the depth there
  float* y = nullptr;
  float* depth = nullptr;
  std::uint8_t* used = nullptr;  ///< 1: the row is wanted; else 0
};

/// The largest triangle, in 1/256 pixel along x and y, whose edge functions 32 bits hold
/// anywhere in the 4x4 blocks of pixels that its bounds touch: their values stay below
/// 2 * 22528 * (22528 + 8 * 256) < 2^31.
inline constexpr std::int32_t kSmallExtent = 88 * 256;

/// The edge functions of a triangle that is not small.
struct LargeEdges {
  EdgeFunctions exact;
  /// In binary64, counted from the triangle's pixel (x_origin, y_origin): exact too if it
  /// extends to no more than kWideExtent.
  std::array<double, 3> edge, per_x, per_y;
  bool fits_doubles;
};

/// In 1/256 pixel along x and y. Values in the blocks that the bounds touch, and the sums on the
/// way to them, stay below 2 * 2^33 * (2^17 + 8) < 2^53.
inline constexpr std::int64_t kWideExtent = 1 << 25;

/// A triangle that is drawn, in two lines of a cache.
struct alignas(64) LaneTriangle {
  // Three times four numbers, which kernels load at once.
  /// Edge functions at the pixel (x_origin, y_origin), of a small triangle.
  std::array<std::int32_t, 3> edge;
  std::int32_t x_origin;
  std::array<std::int32_t, 3> per_x;
  std::int32_t y_origin;
  std::array<std::int32_t, 3> per_y;
  float inverse_area;
  /// At vertex 0 and the differences of the others to it; or a plane's at_origin, per_x, per_y.
  std::array<float, 3> depth;
  std::array<std::int16_t, 4> bounds;     ///< x_begin, y_begin, x_end, y_end
  std::array<std::int8_t, 3> thresholds;  ///< covered where each E >= its threshold: 0 or 1
  bool clockwise;
  bool front_facing;
  std::array<const float*, 3> vertices;
  const LargeEdges* large;  ///< of a triangle that is not small, else null
};
static_assert(offsetof(LaneTriangle, edge) == 0 &&
              offsetof(LaneTriangle, per_x) == 4 * sizeof(float) &&
              offsetof(LaneTriangle, per_y) == 8 * sizeof(float));

/// The chunk's bins begin <= i < end are of one tile.
struct TileBins {
  std::uint32_t tile;
  std::uint32_t begin;
  std::uint32_t end;
};

struct LaneChunk {
  /// The first triangle_count of them; the others are not touched.
  std::unique_ptr<LaneTriangle[]> triangles;
  std::uint32_t triangle_count = 0;
  std::uint32_t triangle_room = 0;
  std::vector<Bin> bins;
  std::vector<TileBins> tiles;
  // What clipping made, and the edges of large triangles; they do not move.
  std::deque<std::array<float, vertex_row_size(kMaxVaryings)>> new_vertices;
  std::deque<LargeEdges> large;
};

/// Empties it, and keeps its memory.
void clear(LaneChunk& chunk);

/// Makes room for more triangles.
void enlarge(LaneChunk& chunk);

/// Appends a triangle, for the caller to fill in.
inline LaneTriangle& next_triangle(LaneChunk& chunk) {
  if (chunk.triangle_count == chunk.triangle_room) enlarge(chunk);
  LaneTriangle& triangle = chunk.triangles[chunk.triangle_count++];
  // Those to come, which were read last in another frame.
  constexpr std::size_t kBytesAhead = 8 * sizeof(LaneTriangle);
  const char* ahead = reinterpret_cast<const char*>(&triangle) + kBytesAhead;
  __builtin_prefetch(ahead, 1);
  __builtin_prefetch(ahead + kLineFloats * sizeof(float), 1);
  return triangle;
}

/// Appends a triangle that was set up by itself, for the caller to give it vertices.
LaneTriangle& add_set_up_triangle(LaneChunk& chunk, const TriangleSetup& setup,
                                  std::size_t provoking, const Profile& profile);

/// Sorts the chunk's triangles into its bins.
void bin_triangles(LaneChunk& chunk, int tiles_x);

/// Tiles are kept in blocks of 4x4 pixels, a block in quads of 2x2 pixels; tiles, blocks
/// and quads row by row. Differences of varyings are taken within a quad.
inline constexpr int kQuadPixels = 4;
inline constexpr int kBlockSize = 4;
inline constexpr int kBlockPixels = kBlockSize * kBlockSize;
inline constexpr int kTileBlocks = kTileSize / kBlockSize;
inline constexpr int kTilePixels = kTileSize * kTileSize;

/// Where a pixel of a tile is kept, by its place in the tile.
inline constexpr std::size_t place_of_pixel(int x, int y) {
  const int block = y / kBlockSize * kTileBlocks + x / kBlockSize;
  return static_cast<std::size_t>(block * kBlockPixels + ((y & 2) + (x >> 1 & 1)) * kQuadPixels +
                                  ((y & 1) * 2 + (x & 1)));
}

/// A run of a tile's triangles that belong to one draw.
struct VisibleRun {
  const DrawCall* draw;
  std::int32_t first_id;
  std::int32_t end_id;
};

/// The depth buffer of a tile while it is drawn, and which triangle is seen in each pixel.
struct VisibilityTile {
  Rectangle area;  ///< in the target; x_begin and y_begin are multiples of kTileSize
  /// Where its pixels go when they are shaded, RGBA16F: the upper left one.
  std::byte* texels;
  std::size_t stride_bytes;
  alignas(64) std::array<float, kTilePixels> depth;
  alignas(64) std::array<std::int32_t, kTilePixels> ids;  ///< from 1 on; 0: none
  std::vector<const LaneTriangle*> triangles;             ///< by id - 1
  std::vector<VisibleRun> runs;
};

/// Begins a tile that shows nothing, at the depth given or as the buffer has it.
void begin_tile(VisibilityTile& tile, const Rectangle& area, const Image& depth,
                std::optional<float> clear_depth);
/// Shades what the tile shows, draw by draw.
void shade_tile(const VisibilityTile& tile);
/// Keeps the depths alone.
void forget_seen(VisibilityTile& tile);
/// Writes the tile's depths.
void end_tile(const VisibilityTile& tile, Image& depth);

/// Ids fit beside a quad's number and its pixels in 32 bits (shade_lanes.inl).
inline constexpr std::size_t kMostVisible = (std::size_t{1} << 18) - 1;

struct alignas(4 * kLineFloats) CacheLine {
  std::array<float, kLineFloats> floats;
};

/// Memory of draws, kept from frame to frame.
struct LaneMemory {
  std::unique_ptr<CacheLine[]> rows;  ///< never all of it touched: few vertices are used
  std::size_t row_lines = 0;
  std::vector<std::int32_t> integer_columns;
  std::vector<float> float_columns;
  std::vector<std::uint8_t> used;  ///< all 0 between frames
  std::vector<LaneChunk> chunks;
};

}  // namespace softfocus

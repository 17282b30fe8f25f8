#pragma once
// A tile while it is drawn in lanes: depths, and the nearest triangle of each pixel. Fragments
// are shaded when all triangles have passed, so that each pixel is shaded once. Of several samples
// a pixel each has a layer; a pixel is shaded once for each triangle that its samples show.

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "raster/images/image.h"
#include "raster/pipeline/draw_call.h"
#include "raster/pipeline/lanes/lane_chunk.h"
#include "raster/pipeline/merge.h"
#include "raster/pipeline/state.h"

namespace softfocus {

/// A tile is kept in blocks of 4x4 pixels, a block in quads of 2x2 pixels; blocks, quads and
/// pixels row by row. Differences of varyings are taken within a quad.
inline constexpr int kQuadPixels = 4;
inline constexpr int kBlockSize = 4;
inline constexpr int kBlockPixels = kBlockSize * kBlockSize;
inline constexpr int kTileBlocks = kTileSize / kBlockSize;
inline constexpr int kTilePixels = kTileSize * kTileSize;

/// The index of pixel (x, y) of a tile.
inline constexpr std::size_t place_of_pixel(int x, int y) {
  const int block = y / kBlockSize * kTileBlocks + x / kBlockSize;
  const int quad = (y & 2) + (x >> 1 & 1);
  const int place = block * kBlockPixels + quad * kQuadPixels + (y & 1) * 2 + (x & 1);
  return static_cast<std::size_t>(place);
}

/// The inverse.
inline constexpr glm::ivec2 pixel_of_place(std::uint32_t place) {
  const std::uint32_t block = place / kBlockPixels;
  return {static_cast<int>(block % kTileBlocks * kBlockSize + (place >> 1 & 2) + (place & 1)),
          static_cast<int>(block / kTileBlocks * kBlockSize + (place >> 2 & 2) + (place >> 1 & 1))};
}

/// A run of a tile's triangles that belong to one draw.
struct VisibleRun {
  const DrawCall* draw;
  std::int32_t first_id;
  std::int32_t end_id;
  std::size_t further_begin = 0;  ///< of VisibilityTile::further
  std::size_t further_end = 0;
};

/// In place of a layer's number: VisibilityTile::further.
inline constexpr std::size_t kFurther = ~std::size_t{0};

/// Pixels of a quad that a triangle shades for a sample, beside those that `ids` of layer 0 tell.
struct FurtherQuad {
  std::int32_t id;
  std::uint16_t number;  ///< place_of_pixel() over four
  std::uint8_t pixels;   ///< a bit each
  std::uint8_t sample;
  std::int32_t shift;  ///< packed_pixel() of where in the pixels, from their centres in 1/256 pixel
};

/// Depths, and the number of the triangle that each pixel shows, from 1 on. 0: none, so it is to
/// be cleared. In a pass that peels, -1 - i: what layer i showed before this tile began. Of several
/// samples, once find_mixed() has run, -1 - i: what sample i shows. Of a sample of an edge, once
/// list_edges() has run: -1: the centre's surface; -2 - i: what sample i of the edge shows.
struct TileLayer {
  alignas(64) std::array<float, kTilePixels> depth;
  alignas(64) std::array<std::int32_t, kTilePixels> ids;
  /// Where shaded pixels go, RGBA16F: the upper left one.
  std::byte* texels;
  std::size_t stride_bytes;
};

inline std::byte* texel_at(const TileLayer& layer, const glm::ivec2& at) {
  return layer.texels + static_cast<std::size_t>(at.y) * layer.stride_bytes +
         static_cast<std::size_t>(at.x) * bytes_per_texel(Format::rgba16f);
}

/// What is shaded next.
struct VisibilityTile {
  Rectangle area;          ///< in the target; x_begin and y_begin are multiples of kTileSize
  std::size_t layers = 1;  ///< those that a pass peels, or a pixel's samples
  bool has_samples = false;
  /// Of edges: so many layers follow those above, a sample each.
  std::size_t edge_samples = 0;
  TileLayer front;
  std::unique_ptr<TileLayer[]> behind;  ///< made on first use
  std::size_t behind_room = 0;
  std::vector<const LaneTriangle*> triangles;  ///< by id - 1
  std::vector<VisibleRun> runs;
  std::vector<FurtherQuad> further;  ///< run by run
  std::vector<std::uint16_t> mixed;  ///< places of pixels that do not show one surface
  /// Texels of edges' samples, sample by sample in rows.
  std::unique_ptr<std::byte[]> edge_texels;
  std::size_t edge_texels_room = 0;

  TileLayer& layer(std::size_t i) { return i == 0 ? front : behind[i - 1]; }
  const TileLayer& layer(std::size_t i) const { return i == 0 ? front : behind[i - 1]; }
};

/// Begins a tile that shows nothing, at `clear_depth` or, without one, at the buffers' depths.
/// Edges need a `clear_depth`. `texels` of its layers are left to be set.
void begin_tile(VisibilityTile& tile, const Rectangle& area, const RenderTargets& targets,
                std::optional<float> clear_depth, int edge_samples = 0);
/// Shades what the tile shows, the farthest layer first, draw by draw. Of several samples needs
/// find_mixed() and list_further().
void shade_tile(const VisibilityTile& tile);
/// Lists, for each run, what samples but the first show that no sample before them does. Needs
/// find_mixed() (mixed_pixels.h).
void list_further(VisibilityTile& tile);

/// Lists, for each run, the surfaces of edges besides their pixels' centres'; `mixed` are left the
/// pixels that have such. Triangles that share a corner, and face the same way, are one surface,
/// which goes on from the one to the other. Samples of a pixel that show one are shaded once: by
/// the triangle that most of them show, the first of these, at the mean of their places. So nothing
/// is extrapolated beyond a triangle, which of slivers leads far away.
void list_edges(VisibilityTile& tile);
/// Gives samples that show what another one does its texel.
void copy_to_samples(const VisibilityTile& tile);
/// Forgets the triangles and keeps the depths.
void forget_seen(VisibilityTile& tile);
/// Leaves nothing, at `clear_depth`, behind pixels whose nearest depth is not less than `before`.
void clear_behind(VisibilityTile& tile, float before, float clear_depth);
/// Writes the tile's depths to the buffers.
void end_tile(const VisibilityTile& tile, const RenderTargets& targets);

/// Up to this id, an id fits beside a quad's number and pixels in 32 bits (shade_lanes.inl).
inline constexpr std::size_t kMostVisible = (std::size_t{1} << 18) - 1;

}  // namespace softfocus

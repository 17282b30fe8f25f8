#pragma once
// A render pass: draw calls are recorded, then carried out together. finish() runs four loops
// over the pool:
//   1. vertices; for draws in lanes their positions alone
//   2. triangles: clip, set up, sort into tiles
//   3. for draws in lanes, the vertices of the triangles that are left
//   4. tiles: fragments
// Within a pixel, fragments merge in the order of submission. So the result depends neither on
// tiles nor on threads. With targets.behind a pass peels (RenderTargets): it gives the nearest
// fragments of each pixel, in the same four loops.
//
//   RenderPass pass{.targets = {.colour = {&picture}, .depth = &depth}, .profile = profile};
//   draw(pass, state, indices, vertex_count, vertex_stage, fragment_stage);   // draw.h
//   finish(pass, pool);

#include <cstdint>
#include <glm/vec4.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "raster/lanes/isa.h"
#include "raster/numbers/profile.h"
#include "raster/pipeline/draw_call.h"
#include "raster/pipeline/lanes/lane_chunk.h"
#include "raster/pipeline/lanes/visibility_tile.h"
#include "raster/pipeline/merge.h"
#include "raster/pipeline/multisample.h"
#include "raster/pipeline/state.h"
#include "raster/threads/parallel.h"

namespace softfocus {

struct RenderPass {
  RenderTargets targets;
  Profile profile;
  /// finish() clears the targets to these before it draws. Without them targets keep their texels.
  /// A pass that peels has both or none.
  std::optional<glm::vec4> clear_colour = {};
  std::optional<float> clear_depth = {};
  /// In a pass that peels and clears: the layers behind the first are wanted only where the first's
  /// depth is less than this. Elsewhere they are clear, and not shaded.
  std::optional<float> behind_before = {};
  /// Whether depths are wanted after finish(). If not, the depth buffer may hold anything then.
  bool keep_depth = true;
  /// The edges of the picture too. Needs a pass that clears, all of whose draws are in lanes, of
  /// one sample a pixel. A tile of more than kMostVisible triangles has none.
  std::optional<EdgeTargets> edges = {};
  /// The vector unit of draws in lanes.
  Isa isa = Isa::scalar;
  std::vector<DrawCall> draws;
  /// Kept from one finish() to the next, as new memory is slow at first.
  LaneMemory memory = {};
};

/// Width and height of the targets, as the rectangle (0, 0) to (width, height). Needs
/// at least one target.
Rectangle target_area(const RenderTargets& targets);

/// The triangles of one chunk of a draw that touch one tile.
struct TileWork {
  const DrawCall* draw;
  std::uint32_t chunk;
  const LaneChunk* lane_chunk;  ///< null for a scalar draw
  std::span<const Bin> bins;
};

/// The work of each tile of a pass, tiles row by row. Valid until the pass changes.
struct TileLists {
  int tiles_x = 0;
  Rectangle area;
  std::vector<TileWork> work;         ///< tile by tile, each in the order of submission
  std::vector<std::uint32_t> begins;  ///< each tile's first in `work`; last, the size of `work`
};

/// Runs loops 1 to 3 of finish() for several passes at once. The memory of `lists` is used
/// again. Needs one list a pass.
void sort_into_tiles(std::span<RenderPass> passes, std::span<TileLists> lists, ThreadPool& pool);

int tile_count(const TileLists& lists);
std::span<const TileWork> work_of_tile(const TileLists& lists, int tile);

/// A tile's pixels.
Rectangle tile_area(const TileLists& lists, int tile);

/// Memory of draw_tile(), made on first use. One tile at a time may use it.
using TileMemory = std::unique_ptr<VisibilityTile>;

/// Clears and draws one tile of the targets. Tiles can be drawn in any order, and by several
/// threads at once, each with its own memory. So passes that show one scene from several points
/// can be drawn tile by tile, while a tile is in a core's cache.
void draw_tile(const RenderPass& pass, const TileLists& lists, int tile, TileMemory& memory);

/// Draws one tile to `texels`, as RGBA16F in rows without gaps. The targets' own tile holds
/// anything afterwards; it is not touched if all draws are in lanes and depths are not kept, and
/// then the targets may be without texels. Needs one colour target, a depth buffer, and both
/// cleared.
void draw_tile_aside(const RenderPass& pass, const TileLists& lists, int tile, TileMemory& memory,
                     std::byte* texels);

/// Carries out the recorded draws and forgets them.
void finish(RenderPass& pass, ThreadPool& pool);

/// What `behind_before`, which is needed, does in one pass, for several on the same targets: clears
/// the layers behind the first where they are not wanted.
void clear_behind(const RenderPass& pass, const glm::vec4& colour, float depth, ThreadPool& pool);

}  // namespace softfocus

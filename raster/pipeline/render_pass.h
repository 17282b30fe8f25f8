#pragma once
// A render pass: draw calls are recorded, then carried out together. finish() runs
// four loops over the pool: vertices; triangles (clip, set up, sort into tiles); of draws in
// lanes, whose vertices were no more than positions, the vertices that these triangles have;
// tiles (fragments). Within a pixel, fragments merge in the order of submission, so
// the result depends neither on tiles nor on threads.
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
#include "raster/threads/parallel.h"
#include "raster/pipeline/draw_call.h"
#include "raster/pipeline/lanes/lane_draw.h"
#include "raster/pipeline/merge.h"
#include "raster/pipeline/state.h"

namespace softfocus {

struct RenderPass {
  RenderTargets targets;
  Profile profile;
  /// What finish() sets the targets to before it draws; none: they keep what they hold.
  std::optional<glm::vec4> clear_colour = {};
  std::optional<float> clear_depth = {};
  /// Whether depths are wanted after finish(): else the depth buffer may hold anything.
  bool keep_depth = true;
  /// Of the draws that are recorded in lanes.
  Isa isa = Isa::scalar;
  std::vector<DrawCall> draws;
  /// Kept from one finish() to the next: memory that is new to a process is slow.
  LaneMemory memory = {};
};

/// Width and height of the targets, as the rectangle (0, 0) to (width, height). Needs
/// at least one target.
Rectangle target_area(const RenderTargets& targets);

/// The triangles of one chunk of a draw that touch one tile.
struct TileWork {
  const DrawCall* draw;
  std::uint32_t chunk;
  const LaneChunk* lane_chunk;  ///< of a draw in lanes
  std::span<const Bin> bins;
};

/// What the tiles of a pass are drawn from, row by row of tiles; good as long as the pass
/// is left as it is.
struct TileLists {
  int tiles_x = 0;
  Rectangle area;
  std::vector<TileWork> work;         ///< tile by tile, each in the order of submission
  std::vector<std::uint32_t> begins;  ///< of each tile in `work`; and its end
};

/// The loops of finish() before the last, for several passes at once; memory of lists is used
/// again. Needs as many lists as passes.
void sort_into_tiles(std::span<RenderPass> passes, std::span<TileLists> lists, ThreadPool& pool);

int tile_count(const TileLists& lists);
std::span<const TileWork> work_of_tile(const TileLists& lists, int tile);

/// A tile's pixels.
Rectangle tile_area(const TileLists& lists, int tile);

/// Memory that draw_tile() needs, for one tile after the other; made on first use.
using TileMemory = std::unique_ptr<VisibilityTile>;

/// Clears and draws one tile of the targets. Tiles can be drawn in any order, and by several
/// threads at once, each with its memory. Passes that show one scene from several points can
/// so be drawn tile by tile, each while the tile is in a core's cache.
void draw_tile(const RenderPass& pass, const TileLists& lists, int tile, TileMemory& memory);

/// The same to another place: the tile's rows of RGBA16F texels without a gap. What the
/// targets hold there is lost. Needs one target for colour, a depth buffer, and that both are
/// cleared.
void draw_tile_aside(const RenderPass& pass, const TileLists& lists, int tile, TileMemory& memory,
                     std::byte* texels);

/// Carries out the recorded draws and forgets them.
void finish(RenderPass& pass, ThreadPool& pool);

}  // namespace softfocus

#pragma once
// Coverage and depth of triangles in a tile, in lanes: the same kernels for every draw.

#include <glm/vec4.hpp>
#include <span>

#include "raster/lanes/isa.h"
#include "raster/numbers/profile.h"
#include "raster/pipeline/draw_call.h"
#include "raster/pipeline/lanes/lane_chunk.h"
#include "raster/pipeline/lanes/visibility_tile.h"

namespace softfocus {

/// Depth-tests the listed triangles of a chunk against a tile, in order, and writes the ids of
/// those that are seen and not discarded. In a tile of several layers a triangle's id goes before
/// the farther ones, and each of these moves back by a layer; of several samples each is tested in
/// its own layer. Needs an isa with vectors; layers that a pass peels need the depth test `less`
/// with depth writes.
void rasterize_lanes(Isa isa, const LaneChunk& chunk, std::span<const Bin> bins,
                     const DrawCall& draw, const Profile& profile, VisibilityTile& tile);

/// Sets the pixels of a tile's first `layers` layers that show nothing. Needs an isa with vectors.
void clear_unseen(Isa isa, const VisibilityTile& tile, std::size_t layers, glm::vec4 value,
                  const Profile& profile);

}  // namespace softfocus

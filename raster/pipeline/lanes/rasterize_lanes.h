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

/// Depth-tests the listed triangles of a chunk against a tile, in order, and puts their ids
/// where they are seen and not discarded; in a tile of several layers, into the layers, of which
/// those that lie behind move back. Needs an isa with vectors, and for layers a test for less that
/// writes.
void rasterize_lanes(Isa isa, const LaneChunk& chunk, std::span<const Bin> bins,
                     const DrawCall& draw, const Profile& profile, VisibilityTile& tile);

/// Sets the pixels of a tile's layers that show nothing. Needs an isa with vectors.
void clear_unseen(Isa isa, const VisibilityTile& tile, glm::vec4 value, const Profile& profile);

}  // namespace softfocus

#pragma once
// The samples of a tile's pixels: which of them show the same, and what they make together.

#include <glm/vec4.hpp>

#include "raster/lanes/isa.h"
#include "raster/numbers/profile.h"
#include "raster/pipeline/lanes/visibility_tile.h"
#include "raster/pipeline/multisample.h"

namespace softfocus {

/// Of a tile of several samples a pixel: finds the pixels whose samples do not all show the same,
/// and marks samples that show what one before them does. Needs an isa with vectors.
void find_mixed(Isa isa, VisibilityTile& tile);

/// Finds the pixels of a tile with edges whose samples show other triangles than their centre.
/// Needs an isa with vectors.
void find_edge_pixels(Isa isa, VisibilityTile& tile);

/// Stores the edges of a tile that is shaded. `clear` is what samples without a triangle show.
/// Needs an isa with vectors.
void store_edges(Isa isa, const VisibilityTile& tile, const EdgeTargets& to, glm::vec4 clear,
                 const Profile& profile);

}  // namespace softfocus

#pragma once
// The samples of a tile's pixels: which of them show the same, and what they make together.

#include <glm/vec4.hpp>

#include "raster/lanes/isa.h"
#include "raster/numbers/profile.h"
#include "raster/pipeline/lanes/visibility_tile.h"
#include "raster/pipeline/multisample.h"

namespace softfocus {

/// Finds the pixels whose samples do not all show the same, and marks samples that show what one
/// before them does: of those pixels, or of all. Needs an isa with vectors.
void find_mixed(Isa isa, VisibilityTile& tile, bool marks_all);

/// Of a tile that is shaded, whose first samples went to the picture: replaces mixed pixels by
/// their surfaces, as find_surfaces(), and sets the coverage of all. `clear` is what samples
/// without a triangle show. Needs an isa with vectors.
void resolve_surfaces(Isa isa, VisibilityTile& tile, const SurfaceTargets& to, glm::vec4 clear,
                      const Profile& profile);

}  // namespace softfocus

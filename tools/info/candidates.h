#pragma once

#include <string>

#include "dof/auto/auto_method.h"
#include "tools/files/json.h"

namespace softfocus {

/// {nearest_px, farthest_px, blurred_share, blur, brightest, ghosts, blurred, lost, near_edges,
/// far_edges}.
Json traits_json(const SceneTraits& traits);

/// "disc-layers:32", "accumulation:64", "pinhole": the line of auto's table, whatever the largest
/// circle.
std::string candidate_id(const AutoMethod& choice);

}  // namespace softfocus

#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "dof/auto/auto_method.h"
#include "dof/auto/candidates.h"
#include "tools/files/json.h"

namespace softfocus {

/// {nearest_px, farthest_px, blurred_share, blur, brightest, ghosts, blurred, lost, near_edges,
/// far_edges}.
Json traits_json(const SceneTraits& traits);

/// "disc-layers:32", "accumulation:64", "pinhole": the line of auto's table, whatever the largest
/// circle.
std::string candidate_id(const AutoMethod& choice);

// Auto's table with other coefficients than its own, for those who fit anew.

/// "disc-layers:32", "accumulation:64", "pinhole": a line of auto's table.
std::string candidate_id(const Candidate& candidate);

/// candidates() with the coefficients of a JSON file, {"two-pass:8": [always, fine, blurred, lost,
/// near_edges, far_edges, ghosts], ...}. A line that the file lacks keeps its own. Throws
/// UsageError that names the file and the line.
std::vector<Candidate> read_candidate_table(const std::filesystem::path& file);

}  // namespace softfocus

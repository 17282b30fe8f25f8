#pragma once
// The animations of a glTF file, by the nodes that they move.

#include <map>

#include "scenes/models/gltf_file.h"
#include "scenes/models/node_motion.h"

namespace softfocus {

/// The tracks of each node that has some, with neither `above` nor `between`. If several animations
/// move a node, the first does. Tracks whose keys are all the same have one key. What cannot be is
/// left out, with a warning.
std::map<int, NodeMotion> read_animations(GltfFile& file);

/// Where a node stands without animations.
NodeMotion standing(const tinygltf::Node& node);

/// Whether any of its own tracks has a second key.
bool moves(const NodeMotion& motion);

}  // namespace softfocus

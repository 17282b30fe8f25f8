#pragma once
// The keys of a shape, which objects and scatters have in common.

#include <string_view>

#include "scenes/load/toml_reading.h"
#include "scenes/scene.h"

namespace softfocus {

/// The mesh that the section's `shape` and that shape's own keys describe, with
/// `texture_repeat` and `inside_out` applied. Throws SceneError.
Mesh read_shape(Section& section);

/// Whether `shape` is "model", which is a file's business and not read_shape's.
bool is_model(Section& section);

/// The largest distance of a point of the mesh from its origin.
double bounding_radius(const Mesh& mesh);

}  // namespace softfocus

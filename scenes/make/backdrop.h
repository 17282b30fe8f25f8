#pragma once
// A scene's backdrop at another distance.

#include <optional>

#include "scenes/scene.h"

namespace softfocus {

/// From the eye to the nearest object of the backdrop; none in a scene without.
std::optional<double> backdrop_distance_m(const Scene& scene);

/// Moves the backdrop, which the scene must have, to that distance, and scales it about the eye: it
/// covers the same part of what the eye sees. The camera sees as much farther. Objects that come
/// nearer than Backdrop::beyond_m belong to it no more.
void set_backdrop(Scene& scene, double distance_m);

}  // namespace softfocus
